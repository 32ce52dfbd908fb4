//! Outcomes as JUnit's XML, which build servers read: an asset is a test.

use super::outcome::{Outcome, Status};
use crate::error::{Error, Kind, Result};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use std::time::Duration;

/// The text of the file.
///
/// # Errors
/// Where it cannot be encoded.
pub fn junit(outcomes: &[Outcome]) -> Result<String> {
    let mut suite = TestSuite::new("library");
    for outcome in outcomes {
        let status = match (&outcome.fault, outcome.status) {
            (Some(fault), _) => {
                let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
                status.set_message(fault.reason.as_str());
                status
            }
            (None, Status::NotRun) => TestCaseStatus::skipped(),
            (None, _) => TestCaseStatus::success(),
        };
        let mut case = TestCase::new(outcome.input.to_string_lossy().as_ref(), status);
        case.set_classname("furrier.batch");
        let spent = if outcome.status == Status::Baked { outcome.seconds } else { 0.0 };
        case.set_time(Duration::try_from_secs_f64(spent).unwrap_or_default());
        if !outcome.warnings.is_empty() {
            case.set_system_err(outcome.warnings.join("\n").as_str());
        }
        suite.add_test_case(case);
    }
    let mut report = Report::new("furrier batch");
    report.add_test_suite(suite);
    report.to_string().map_err(|error| Error::new(Kind::Output, "the JUnit file cannot be encoded").with_found(error))
}
