//! `costate modes --speed`: modes over the rate of a steady turn, followed by their shapes through crossings.

use super::console::print;
use super::failure::Failure;
use crate::io::{Cell, Chart, Series, Style, Table, number, write_charts, write_csv};
use costate::integrators::Mode;
use costate::scenes::Prepared;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Multiples of the rate that are drawn beside the modes: where a blade passes, loads come so often.
const ORDERS: [usize; 4] = [1, 2, 3, 4];
const SHOWN: usize = 8;

/// Modes at each rate, in the order of branches; `None` where a branch has none.
pub struct Branches {
    rates: Vec<f64>,
    modes: Vec<Vec<Option<Mode>>>,
}

/// How alike two modes are, from 0 to 1: the share of one that lies along the other.
fn likeness(one: &Mode, other: &Mode) -> f64 {
    let product = |a: &Mode, b: &Mode| {
        let parts = a.shape.iter().zip(&a.ahead).zip(b.shape.iter().zip(&b.ahead));
        parts.fold([0.0; 2], |[re, im], ((ar, ai), (br, bi))| [re + ar * br + ai * bi, im + ar * bi - ai * br])
    };
    let [[re, im], [own, _], [beside, _]] = [product(one, other), product(one, one), product(other, other)];
    re.hypot(im) / (own * beside).sqrt()
}

impl Branches {
    pub fn follow(prepared: &mut Prepared, rates: &[f64], count: usize) -> Result<Self, Failure> {
        let mut branches = Branches { rates: rates.to_vec(), modes: Vec::new() };
        let own = prepared.spin_rate();
        for &rate in rates {
            prepared.turn_at(rate);
            let found = prepared.complex_modes_with_state(count).map_err(|error| {
                let failure = Failure::from(error);
                Failure { message: format!("at {} rad/s: {}", number(rate), failure.message), ..failure }
            })?;
            branches.add(found.1);
        }
        // what is drawn of the scene afterwards turns at its own rate
        own.into_iter().for_each(|rate| prepared.turn_at(rate));
        Ok(branches)
    }

    /// Puts each mode on the branch whose last mode it is most like.
    fn add(&mut self, found: Vec<Mode>) {
        let last = |branch: usize| self.modes.iter().rev().find_map(|row| row.get(branch)?.as_ref());
        let count = self.modes.iter().map(Vec::len).max().unwrap_or(0);
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (branch, before) in (0..count).filter_map(|branch| Some((branch, last(branch)?))) {
            pairs.extend(found.iter().enumerate().map(|(own, mode)| (likeness(before, mode), branch, own)));
        }
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut row: Vec<Option<Mode>> = vec![None; count];
        let mut found: Vec<Option<Mode>> = found.into_iter().map(Some).collect();
        for (_, branch, own) in pairs {
            if row[branch].is_none() {
                row[branch] = found[own].take();
            }
        }
        row.extend(found.into_iter().filter(Option::is_some));
        self.modes.push(row);
    }

    fn count(&self) -> usize {
        self.modes.iter().map(Vec::len).max().unwrap_or(0)
    }

    fn at(&self, row: usize, branch: usize) -> Option<&Mode> {
        self.modes[row].get(branch)?.as_ref()
    }

    /// The frequencies over rates, with multiples of these.
    pub fn chart(&self, title: String) -> Chart {
        let curve = |branch: usize| Series {
            name: format!("mode {}", branch + 1),
            points: (0..self.rates.len())
                .filter_map(|row| Some((self.rates[row], self.at(row, branch)?.frequency)))
                .collect(),
            style: Style::Both,
        };
        let modes: Vec<Series> = (0..self.count()).map(curve).collect();
        let most = modes.iter().flat_map(|own| &own.points).fold(0.0, |most: f64, point| most.max(point.1));
        let order = |order: usize| Series {
            name: format!("{order} per turn"),
            points: self.rates.iter().map(|rate| (*rate, rate.abs() * order as f64)).filter(|own| own.1 <= most).collect(),
            style: Style::Line,
        };
        Chart {
            title,
            x_label: "rate of the turn [rad/s]".into(),
            y_label: "frequency in the frame that turns [rad/s]".into(),
            series: modes.into_iter().chain(ORDERS.map(order)).filter(|own| own.points.len() > 1).collect(),
            ..Chart::default()
        }
    }

    pub fn print(&self) {
        let names: Vec<String> = (1..=self.count().min(SHOWN)).map(|own| format!("mode {own}")).collect();
        let mut table =
            Table::new(&["rate [rad/s]"].into_iter().chain(names.iter().map(String::as_str)).collect::<Vec<_>>());
        for (row, rate) in self.rates.iter().enumerate() {
            let cell = |branch: usize| match self.at(row, branch) {
                Some(mode) if mode.is_unstable() => format!("{} (grows)", number(mode.frequency)),
                Some(mode) => number(mode.frequency),
                None => String::new(),
            };
            table.row([number(*rate)].into_iter().chain((0..names.len()).map(cell)).map(Cell::from));
        }
        print(format_args!("frequencies in the frame that turns [rad/s]\n\n{table}\n"));
    }

    pub fn write(&self, title: String, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
        let of_branch = |branch: usize| [format!("frequency {branch} [rad/s]"), format!("growth {branch} [1/s]")];
        let header: Vec<String> =
            ["rate [rad/s]".to_string()].into_iter().chain((1..=self.count()).flat_map(of_branch)).collect();
        let row = |row: usize| {
            let numbers = |branch| self.at(row, branch).map_or([f64::NAN; 2], |mode| [mode.frequency, mode.growth]);
            [self.rates[row]].into_iter().chain((0..self.count()).flat_map(numbers)).collect::<Vec<f64>>()
        };
        let files = ["campbell.csv", "campbell.svg"].map(|name| folder.join(name));
        write_csv(&files[0], &header, (0..self.rates.len()).map(row))?;
        write_charts(&[self.chart(title)], &files[1])?;
        Ok(files.to_vec())
    }

    pub fn json(&self) -> Value {
        let of_mode = |mode: &Mode| json!({"omega_rad_s": mode.frequency, "growth_1_s": mode.growth});
        let rows = self.rates.iter().zip(&self.modes).map(|(rate, row)| {
            let modes: Vec<Value> = row.iter().map(|mode| mode.as_ref().map_or(Value::Null, of_mode)).collect();
            json!({"rate_rad_s": *rate, "modes": modes})
        });
        rows.collect()
    }
}
