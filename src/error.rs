//! The one error type: what went wrong, where, what was found, what was expected, what to try.

use std::fmt;
use std::path::{Path, PathBuf};

/// What kind of failure this is; decides the exit code (`docs/cli.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The command line or a preset asks for something impossible.
    Usage,
    /// An input file is missing, broken or unsupported.
    Input,
    /// An output could not be written.
    Output,
    /// No graphics adapter, or it failed.
    Device,
    /// A comparison exceeded its limit (`compare`, `report coat`, `batch`).
    Difference,
    /// Some of many assets failed (`batch`).
    Some,
    /// The machine failed, not an asset: another or a later try may succeed (`batch run`). As `EX_TEMPFAIL` of BSD's sysexits.h.
    Machine,
}

impl Kind {
    /// Process exit code of this kind of failure.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Difference => 1,
            Self::Usage => 2,
            Self::Input => 3,
            Self::Output => 4,
            Self::Device => 5,
            Self::Some => 6,
            Self::Machine => 75,
        }
    }
}

/// A failure as a person needs to read it. Build with [`Error::new`] and the `with_*` methods.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// Decides the exit code.
    pub kind: Kind,
    /// One sentence without a full stop.
    pub what: String,
    /// The file concerned.
    pub file: Option<PathBuf>,
    /// The place inside it, e.g. `accessors[3].count`.
    pub field: Option<String>,
    /// What was asked for and cannot be, as the library calls it, e.g. `texture size`; the command line names its flag.
    pub parameter: Option<&'static str>,
    /// The value found there.
    pub found: Option<String>,
    /// The values that would have been accepted.
    pub expected: Option<String>,
    /// What to try next.
    pub hint: Option<String>,
}

/// Shorthand used throughout the crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// A failure of `kind`, described by `what`.
    pub fn new(kind: Kind, what: impl Into<String>) -> Self {
        Self {
            kind,
            what: what.into(),
            file: None,
            field: None,
            parameter: None,
            found: None,
            expected: None,
            hint: None,
        }
    }

    /// A broken or unsupported input.
    pub fn input(what: impl Into<String>) -> Self {
        Self::new(Kind::Input, what)
    }

    /// An impossible request.
    pub fn usage(what: impl Into<String>) -> Self {
        Self::new(Kind::Usage, what)
    }

    /// Names the file, unless a deeper call already did.
    pub fn with_file(mut self, file: impl AsRef<Path>) -> Self {
        self.file.get_or_insert_with(|| file.as_ref().to_owned());
        self
    }

    /// Names the field.
    pub fn with_field(mut self, field: impl Into<String>) -> Self {
        self.field = Some(field.into());
        self
    }

    /// Names the parameter: words, as they stand in a flag's name.
    pub fn with_parameter(mut self, parameter: &'static str) -> Self {
        self.parameter = Some(parameter);
        self
    }

    /// States the value found.
    pub fn with_found(mut self, found: impl fmt::Display) -> Self {
        self.found = Some(found.to_string());
        self
    }

    /// States what would have been accepted.
    pub fn with_expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// Says what to try.
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)?;
        if let Some(file) = &self.file {
            write!(f, "\n  file: {}", file.display())?;
        }
        let place = self.field.as_deref().or(self.parameter);
        let lines = [("field", place), ("found", self.found.as_deref()), ("expected", self.expected.as_deref())];
        for (label, value) in lines {
            if let Some(value) = value {
                write!(f, "\n  {label}: {value}")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for Error {}

impl miette::Diagnostic for Error {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.hint.as_ref().map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }
}
