//! One line and an exit status for everything that goes wrong.

use std::fmt;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use hashcache::image_file::ImageError;
use hashcache::scene::SceneError;

/// Why the command stops.
#[derive(Debug)]
pub struct Failure {
    /// 2 when the command line is wrong whatever the files hold, else 1.
    pub status: u8,
    line: String,
}

impl Failure {
    /// The command line is wrong.
    pub fn usage(line: impl Into<String>) -> Self {
        Self { status: 2, line: line.into() }
    }

    /// Anything else.
    pub fn other(line: impl Into<String>) -> Self {
        Self { status: 1, line: line.into() }
    }
}

impl fmt::Display for Failure {
    /// One line whatever file names and libraries put into it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = self.line.split(char::is_control).filter(|part| !part.trim().is_empty());
        f.write_str(&words.collect::<Vec<_>>().join(" "))
    }
}

impl From<hashcache::Error> for Failure {
    fn from(error: hashcache::Error) -> Self {
        match error {
            hashcache::Error::Settings(error) => Self::usage(error.to_string()),
            hashcache::Error::Image(error) => error.into(),
            hashcache::Error::Scene(
                error @ (SceneError::UnknownFormat { .. }
                | SceneError::UnknownBuiltin { .. }
                | SceneError::OutOfRange { .. }),
            ) => Self::usage(error.to_string()),
            error => Self::other(error.to_string()),
        }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::UnknownFormat(_) => Self::usage(error.to_string()),
            error => Self::other(error.to_string()),
        }
    }
}

impl From<clap::Error> for Failure {
    /// Clap explains itself in paragraphs; this keeps what was wrong and what would be right.
    fn from(error: clap::Error) -> Self {
        let text = |kind| error.get(kind).map(ToString::to_string).filter(|text| !text.is_empty());
        let list = |kind| match error.get(kind) {
            Some(ContextValue::Strings(names)) => names.join(", "),
            Some(other) => other.to_string(),
            None => String::new(),
        };
        let option = |text: String| text.split([' ', '=']).next().unwrap_or_default().to_owned();
        let line = match error.kind() {
            ErrorKind::InvalidValue => {
                let (name, known) = (text(ContextKind::InvalidArg).map(option), list(ContextKind::ValidValue));
                let (name, value) = (name.unwrap_or_default(), text(ContextKind::InvalidValue));
                match (value, known.is_empty()) {
                    (Some(value), _) => format!("{name} {value}: not possible; it takes {known}"),
                    (None, true) => format!("{name}: a value is missing"),
                    (None, false) => format!("{name}: a value is missing; it takes {known}"),
                }
            }
            ErrorKind::UnknownArgument => {
                let name = text(ContextKind::InvalidArg).unwrap_or_default();
                match text(ContextKind::SuggestedArg) {
                    Some(near) => format!("{name}: there is no such option; {near} is near, --help lists all"),
                    None => format!("{name}: not expected here; --help lists all options"),
                }
            }
            ErrorKind::InvalidSubcommand => {
                let name = text(ContextKind::InvalidSubcommand).unwrap_or_default();
                format!("{name}: there is no such command; there are {}", commands())
            }
            ErrorKind::MissingSubcommand | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                format!("a command is missing; there are {}", commands())
            }
            ErrorKind::MissingRequiredArgument => {
                format!("{} is missing; --help shows how", list(ContextKind::InvalidArg).replace(['<', '>'], ""))
            }
            _ => {
                let whole = error.to_string();
                let first = whole.lines().next().unwrap_or_default();
                first.strip_prefix("error: ").unwrap_or(first).to_owned()
            }
        };
        Self::usage(line)
    }
}

/// The names of all commands.
fn commands() -> String {
    use clap::CommandFactory as _;
    let command = crate::args::Cli::command();
    command.get_subcommands().map(clap::Command::get_name).collect::<Vec<_>>().join(", ")
}
