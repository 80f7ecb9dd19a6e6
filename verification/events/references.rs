//! Values and derivatives to compare with.

/// The numbers of the file.
pub struct References(Vec<([&'static str; 3], f64)>);

impl References {
    /// Reads `references.csv`: case, functional, variable or "value", number.
    pub fn read() -> Result<Self, String> {
        let row = |line: &'static str| {
            let fields: Vec<&str> = line.split(',').collect();
            let [case, functional, variable, number] = fields[..] else {
                return Err(format!("\"{line}\" has no four fields"));
            };
            let number = number.parse::<f64>().map_err(|why| format!("\"{line}\": {why}"))?;
            Ok(([case, functional, variable], number))
        };
        let rows = include_str!("references.csv").lines().skip(1).map(row);
        Ok(References(rows.collect::<Result<_, String>>()?))
    }

    /// The value of a functional of a case.
    pub fn value(&self, case: &str, functional: &str) -> Result<f64, String> {
        let found = self.derivative(case, functional, "value");
        found.ok_or_else(|| format!("there is no value of \"{functional}\" of {case}"))
    }

    /// Its derivative by a variable, if there is one.
    pub fn derivative(&self, case: &str, functional: &str, variable: &str) -> Option<f64> {
        self.0.iter().find(|own| own.0 == [case, functional, variable]).map(|own| own.1)
    }
}
