//! The range of an axis and the numbers along it.

/// An axis that maps values to 0..1, linearly or by the decimal logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// Ends of the axis; decimal logarithms of them when `log`.
    pub lo: f64,
    pub hi: f64,
    pub log: bool,
}

/// A number on the axis; minor marks have an empty label.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mark {
    pub value: f64,
    pub label: String,
}

/// The marks of an axis and what their labels leave out, as in `×10⁻⁹ + 1.5`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Marks {
    pub list: Vec<Mark>,
    pub factor: String,
}

impl Scale {
    /// The smallest axis around all drawable `values`, widened by the fraction `margin` at both ends.
    ///
    /// No values give 0..1 (1..10 when `log`); a constant gets room above and below.
    pub fn around(values: impl Iterator<Item = f64>, log: bool, margin: f64) -> Self {
        let used = values.filter(|&v| drawable(v, log)).map(|v| if log { v.log10() } else { v });
        let (lo, hi) = used.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if lo > hi {
            return Self { lo: 0.0, hi: 1.0, log };
        }
        let largest = lo.abs().max(hi.abs());
        // below this width the marks are not distinct in double precision: constant up to rounding
        let smallest = if log { 1e-9 } else { (1e-12 * largest).max(1e-290) };
        if hi - lo <= smallest {
            let room = if log || largest < 1e-290 { 0.5 } else { 0.05 * largest };
            return Self { lo: lo - room, hi: hi + room, log };
        }
        let room = margin * (hi - lo);
        Self { lo: lo - room, hi: hi + room, log }
    }

    /// Position of `value` along the axis, 0 at its start and 1 at its end.
    pub fn at(&self, value: f64) -> f64 {
        let value = if self.log { value.log10() } else { value };
        (value - self.lo) / (self.hi - self.lo)
    }

    /// About `most` marks at round numbers.
    pub fn marks(&self, most: usize) -> Marks {
        if !self.log {
            return linear(self.lo, self.hi, most);
        }
        let decades = self.hi - self.lo;
        if decades < 0.7 {
            return linear(10f64.powf(self.lo), 10f64.powf(self.hi), most);
        }
        let stride = (decades / most as f64).ceil().max(1.0) as i32;
        let mut list = Vec::new();
        for exponent in self.lo.floor() as i32..=self.hi.ceil() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(exponent);
                let labelled = match digit {
                    1 => exponent.rem_euclid(stride) == 0,
                    2 | 5 => decades < 2.0,
                    _ => false,
                };
                // over many decades minor marks are a grey bar
                if (-1e-9..=1.0 + 1e-9).contains(&self.at(value)) && (digit == 1 || decades < 4.5) {
                    let digits = if digit == 1 { String::new() } else { format!("{digit}×") };
                    let label = if labelled { format!("{digits}10{}", superscript(exponent)) } else { String::new() };
                    list.push(Mark { value, label });
                }
            }
        }
        Marks { list, factor: String::new() }
    }
}

/// Whether `value` has a place on an axis: finite, not absurdly large, and positive when `log`.
pub(super) fn drawable(value: f64, log: bool) -> bool {
    value.abs() <= 1e300 && (!log || value >= 1e-300)
}

/// The largest of 1, 2, 5 times a power of ten that gives no more than `most` steps in `span`.
pub(super) fn round_step(span: f64, most: usize) -> f64 {
    let raw = span / most.max(1) as f64;
    let power = 10f64.powi(raw.log10().floor() as i32);
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|digit| digit * power).find(|step| *step >= raw * (1.0 - 1e-9)).unwrap_or(raw)
}

fn linear(lo: f64, hi: f64, most: usize) -> Marks {
    let span = hi - lo;
    let step = round_step(span, most);
    let first = (lo / step - 1e-6).ceil();
    let count = ((hi / step + 1e-6).floor() - first) as usize;
    let values: Vec<f64> = (0..=count).map(|index| (first + index as f64) * step).collect();

    // a narrow range far from zero is labelled by its distance from a round number
    let mut offset = 0.0;
    let mut offset_text = String::new();
    if span < 1e-4 * lo.abs().max(hi.abs()) {
        let exponent = span.log10().ceil() as i32 + 1;
        let unit = 10f64.powi(exponent);
        offset = (0.5 * (lo + hi) / unit).round() * unit;
        let digits = (offset.abs().log10().floor() as i32 - exponent).clamp(0, 16) as usize;
        offset_text = plain_or_power(offset, digits);
    }
    let largest = values.iter().map(|value| (value - offset).abs()).fold(0.0, f64::max);
    let exponent =
        if largest == 0.0 || (1e-3..1e5).contains(&largest) { 0 } else { 3 * (largest.log10() / 3.0 + 1e-9).floor() as i32 };
    let unit = 10f64.powi(exponent);
    let decimals = (-(step / unit).log10() - 1e-9).ceil().max(0.0) as usize;
    let label = |value: f64| {
        // the half step keeps "-0" away
        let shown = if (value - offset).abs() < 0.5 * step { 0.0 } else { (value - offset) / unit };
        format!("{shown:.decimals$}").replace('-', "−")
    };
    let list = values.iter().map(|&value| Mark { value, label: label(value) }).collect();
    let power = if exponent == 0 { String::new() } else { format!("×10{}", superscript(exponent)) };
    let factor = if offset == 0.0 {
        power
    } else {
        let sign = if offset < 0.0 { "−" } else { "+" };
        format!("{power} {sign} {offset_text}").trim_start().to_owned()
    };
    Marks { list, factor }
}

/// |value| with `digits` significant digits after the first, without trailing zeros.
fn plain_or_power(value: f64, digits: usize) -> String {
    let text = format!("{:.digits$e}", value.abs());
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trim = |text: &str| {
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text.to_owned() }
    };
    if (-3..7).contains(&exponent) {
        trim(&format!("{:.*}", (digits as i32 - exponent).max(0) as usize, value.abs()))
    } else {
        format!("{}×10{}", trim(mantissa), superscript(exponent))
    }
}

fn superscript(exponent: i32) -> String {
    let digit = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => char::from_u32(c as u32 - '0' as u32 + '⁰' as u32).unwrap_or(c),
    };
    exponent.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(lo: f64, hi: f64, log: bool) -> (Vec<String>, String) {
        let marks = Scale::around([lo, hi].into_iter(), log, 0.0).marks(6);
        (marks.list.into_iter().map(|mark| mark.label).filter(|label| !label.is_empty()).collect(), marks.factor)
    }

    #[test]
    fn ordinary_ranges_have_plain_labels() {
        assert_eq!(
            labels(0.0, 1.0, false),
            (["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"].map(String::from).to_vec(), String::new())
        );
        assert_eq!(labels(-10.0, 20.0, false).0, ["−10", "−5", "0", "5", "10", "15", "20"].map(String::from));
    }

    #[test]
    fn small_and_large_ranges_share_a_power_of_ten() {
        assert_eq!(
            labels(0.0, 2e-9, false),
            (["0.0", "0.5", "1.0", "1.5", "2.0"].map(String::from).to_vec(), "×10⁻⁹".into())
        );
        assert_eq!(labels(0.0, 2.1e11, false).1, "×10⁹");
        assert_eq!(labels(-1e-285, 1e-285, false).1, "×10⁻²⁸⁵");
        assert_eq!(labels(-1e300, 1e300, false).1, "×10³⁰⁰");
    }

    #[test]
    fn a_narrow_range_is_labelled_from_a_round_number() {
        let (list, factor) = labels(1.5 + 1e-9, 1.5 + 3e-9, false);
        assert_eq!(factor, "×10⁻⁹ + 1.5");
        assert_eq!(list, ["1.0", "1.5", "2.0", "2.5", "3.0"].map(String::from));
    }

    #[test]
    fn logarithmic_marks_are_decades() {
        assert_eq!(labels(1e-3, 1e2, true).0, ["10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹", "10²"].map(String::from));
        assert!(labels(1e-280, 1e280, true).0.len() <= 8);
        assert!(labels(2.0, 3.0, true).0.len() >= 3);
    }

    #[test]
    fn every_range_has_distinct_labels() {
        let ends =
            [0.0, 1e-305, 1e-9, 1.0, 1.0 + 1e-15, 1.0 + 1e-9, 123456.7, 1e9, 1e299, -1.0, -1e-9, f64::NAN, f64::INFINITY];
        for (lo, hi) in ends.iter().flat_map(|a| ends.iter().map(move |b| (*a, *b))) {
            for log in [false, true] {
                let (list, factor) = labels(lo, hi, log);
                let mut sorted = list.clone();
                sorted.sort();
                sorted.dedup();
                assert!(
                    list.len() >= 2 && list.len() <= 14 && sorted.len() == list.len(),
                    "{lo} {hi} {log}: {list:?} {factor}"
                );
                assert!(list.iter().all(|label| label.chars().count() <= 9), "{lo} {hi} {log}: {list:?} {factor}");
            }
        }
    }

    #[test]
    fn empty_and_constant_data_have_an_axis() {
        assert_eq!(Scale::around([].into_iter(), false, 0.05), Scale { lo: 0.0, hi: 1.0, log: false });
        let scale = Scale::around([7.0; 3].into_iter(), false, 0.05);
        assert!(scale.lo < 7.0 && scale.hi > 7.0 && (scale.at(7.0) - 0.5).abs() < 1e-12);
    }
}
