use crate::io::IoError;
use costate::exchange::sent_by_fields;
use costate::integrators::RunError;

/// Why the program ends without success: exit code and one message.
#[derive(Debug)]
pub struct Failure {
    /// 1: a run failed or a check is out of tolerance; 2: bad input; 3: a limit of iterations was reached; 130: interrupted.
    pub code: u8,
    /// What goes to stderr.
    pub message: String,
}
sent_by_fields!(Failure { code, message });

/// Exit code of an optimization that its limit of iterations ended.
pub const LIMIT_REACHED: u8 = 3;
pub const INTERRUPTED: u8 = 130;

impl Failure {
    pub fn input(message: impl Into<String>) -> Self {
        Failure { code: 2, message: message.into() }
    }

    /// A run that failed, or a result out of tolerance.
    pub fn run(message: impl Into<String>) -> Self {
        Failure { code: 1, message: message.into() }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let message = error.to_string();
        match error {
            RunError::Input(_) => {
                Failure::input(message.replace("start to be projected", "start to be projected (--project-start)"))
            }
            RunError::Interrupted { .. } => Failure { code: INTERRUPTED, message },
            _ => Failure::run(message),
        }
    }
}

impl From<IoError> for Failure {
    fn from(error: IoError) -> Self {
        Failure::run(error.to_string())
    }
}
