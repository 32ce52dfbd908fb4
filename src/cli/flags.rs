//! Flags by the names that the library has for what they set: it speaks of the texture size, a user of `--texture-size`.

use crate::error::Error;
use clap::{ArgMatches, Command};

/// The long flags of the subcommand that runs, without their dashes.
#[derive(Default)]
pub struct Flags(Vec<String>);

impl Flags {
    /// Those of the innermost subcommand of `command` that `matches` names.
    pub fn of(command: &Command, matches: &ArgMatches) -> Self {
        match matches.subcommand().and_then(|(name, inner)| Some((command.find_subcommand(name)?, inner))) {
            Some((command, inner)) => Self::of(command, inner),
            None => Self(command.get_arguments().filter_map(|flag| flag.get_long()).map(str::to_owned).collect()),
        }
    }

    /// The flag that sets the parameter; none where the subcommand has none.
    fn flag(&self, parameter: &str) -> Option<String> {
        let name = parameter.replace(' ', "-");
        self.0.contains(&name).then(|| format!("--{name}"))
    }

    /// `text` with flags where it has parameters between backquotes.
    pub fn in_text(&self, text: &str) -> String {
        let flagged = |(i, part): (usize, &str)| match self.flag(part) {
            Some(flag) if i % 2 == 1 => flag,
            _ => part.to_owned(),
        };
        text.split('`').enumerate().map(flagged).collect::<Vec<_>>().join("`")
    }

    /// An error that names flags: the one it is about before the place within what that was given.
    pub fn in_error(&self, error: Error) -> Error {
        let flag = error.parameter.map(|parameter| self.flag(parameter).unwrap_or_else(|| parameter.to_owned()));
        let place: Vec<String> = flag.into_iter().chain(error.field).collect();
        Error {
            what: self.in_text(&error.what),
            field: (!place.is_empty()).then(|| place.join(" ")),
            expected: error.expected.map(|text| self.in_text(&text)),
            hint: error.hint.map(|text| self.in_text(&text)),
            ..error
        }
    }
}
