//! Rates over which something is looked at, as options give them.

const MOST: usize = 10_000;

/// Rates from a first to a last one [rad/s].
#[derive(Clone, Debug, PartialEq)]
pub struct Rates {
    pub list: Vec<f64>,
    pub are_logarithmic: bool,
}

impl std::str::FromStr for Rates {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            "it must be FIRST:LAST:NUMBER, rates [rad/s] and how many of them, as 0:120:25, or with :log behind them as 1:1000:60:log"
                .to_string()
        };
        let (numbers, are_logarithmic) = text.strip_suffix(":log").map_or((text, false), |numbers| (numbers, true));
        let [first, last, count] = numbers.split(':').collect::<Vec<_>>().try_into().map_err(|_| wrong())?;
        let rate = |text: &str| text.parse::<f64>().ok().filter(|rate| rate.is_finite()).ok_or_else(wrong);
        let ([first, last], count) = ([rate(first)?, rate(last)?], count.parse::<usize>().map_err(|_| wrong())?);
        if !(2..=MOST).contains(&count) || first >= last {
            return Err(format!("the first rate must lie below the last one, and their number between 2 and {MOST}"));
        }
        if are_logarithmic && first <= 0.0 {
            return Err("rates in equal steps of the logarithm must be greater than 0".into());
        }
        let share = |k: usize| k as f64 / (count - 1) as f64;
        let at = |k: usize| match are_logarithmic {
            _ if k + 1 == count => last,
            true => first * (last / first).powf(share(k)),
            false => first + (last - first) * share(k),
        };
        Ok(Rates { list: (0..count).map(at).collect(), are_logarithmic })
    }
}
