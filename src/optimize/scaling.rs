use crate::design::DesignVariable;

/// Between designs and the variables of a program: x = offset + size y for those that vary.
///
/// Between finite bounds y runs from 0 to 1; otherwise it is measured by the size of its start.
#[derive(Clone, Debug)]
pub(super) struct Scaling {
    /// The design whose other variables are kept.
    start: Vec<f64>,
    /// Those of it that vary, scaled.
    origin: Vec<f64>,
    /// Bounds of all variables.
    bounds: Vec<(f64, f64)>,
    /// Which variables vary.
    pub varying: Vec<usize>,
    /// Offset and size of those that vary.
    pub measures: Vec<(f64, f64)>,
}

impl Scaling {
    pub fn new(variables: &[DesignVariable], start: &[f64], varying: Vec<usize>) -> Self {
        let bounds: Vec<(f64, f64)> = variables.iter().map(|variable| (variable.lower, variable.upper)).collect();
        let measure = |&index: &usize| {
            let (lower, upper) = bounds[index];
            let (range, size) = (upper - lower, start[index].abs());
            match () {
                () if range.is_finite() && range > 0.0 => (lower, range),
                () if size > 0.0 => (0.0, size),
                () => (0.0, 1.0),
            }
        };
        let measures = varying.iter().map(measure).collect();
        let mut scaling = Scaling { start: start.to_vec(), origin: Vec::new(), bounds, varying, measures };
        scaling.origin = scaling.scaled(start);
        scaling
    }

    /// The variables of a program for a design.
    pub fn scaled(&self, design: &[f64]) -> Vec<f64> {
        let pairs = self.varying.iter().zip(&self.measures);
        pairs.map(|(&index, (offset, size))| (design[index] - offset) / size).collect()
    }

    /// The design for the variables of a program: within its bounds, and at the start, to the last digit.
    pub fn design(&self, y: &[f64]) -> Vec<f64> {
        let mut design = self.start.clone();
        let moved = (0..y.len()).filter(|&i| y[i] != self.origin[i]);
        for i in moved {
            let (index, (offset, size)) = (self.varying[i], self.measures[i]);
            let (lower, upper) = self.bounds[index];
            design[index] = (offset + size * y[i]).clamp(lower, upper);
        }
        design
    }

    /// Bounds of the variables of a program.
    pub fn bounds(&self) -> Vec<(f64, f64)> {
        let pairs = self.varying.iter().zip(&self.measures);
        pairs.map(|(&i, (offset, size))| ((self.bounds[i].0 - offset) / size, (self.bounds[i].1 - offset) / size)).collect()
    }

    /// From a gradient with respect to the design to one with respect to the variables of a program.
    pub fn gradient(&self, of_design: &[f64]) -> Vec<f64> {
        self.varying.iter().zip(&self.measures).map(|(&index, (_, size))| of_design[index] * size).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn designs_go_to_the_variables_of_a_program_and_back() {
        let variables = [
            DesignVariable::new("length", 1.3, (0.1, 0.7 + 0.9), "m"),
            DesignVariable::new("stiffness", -40.0, (f64::NEG_INFINITY, 0.0), "N/m"),
            DesignVariable::new("kept", 7.0, (0.0, 9.0), "kg"),
        ];
        let scaling = Scaling::new(&variables, &[1.3, -40.0, 7.0], vec![0, 1]);
        assert_eq!(scaling.scaled(&[1.3, -40.0, 7.0]), [(1.3 - 0.1) / (1.6 - 0.1), -1.0]);
        assert_eq!(scaling.design(&scaling.scaled(&[1.3, -40.0, 7.0])), [1.3, -40.0, 7.0]);
        assert_eq!(scaling.bounds(), [(0.0, 1.0), (f64::NEG_INFINITY, 0.0)]);
        // the upper bound itself, whatever the round-off
        assert_eq!(scaling.design(&[1.0, -2.0]), [variables[0].upper, -80.0, 7.0]);
        assert_eq!(scaling.gradient(&[2.0, 3.0, 5.0]), [2.0 * (1.6 - 0.1), 120.0]);
    }
}
