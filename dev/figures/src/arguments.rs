//! What follows the verb.

use std::path::PathBuf;

use hashcache::Settings;

/// Scenes by name, settings to change, and where other programs' figures are.
#[derive(Debug, Default)]
pub struct Arguments {
    /// Names of scenes; none: the verb's own selection.
    scenes: Vec<String>,
    /// Settings by key and value, in the order given.
    set: Vec<(String, String)>,
    /// JSON lines of the peers' script; else the table of the references' README is read.
    pub peer: Option<PathBuf>,
}

impl Arguments {
    /// Reads the words after the verb.
    pub fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut arguments = Self::default();
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} wants a value"));
            match word.as_str() {
                "--set" => {
                    let pair = value()?;
                    let (key, value) = pair.split_once('=').ok_or(format!("--set {pair}: KEY=VALUE expected"))?;
                    arguments.set.push((key.to_owned(), value.to_owned()));
                }
                "--peer" => arguments.peer = Some(value()?.into()),
                flag if flag.starts_with('-') => return Err(format!("{flag}: there are --set KEY=VALUE, --peer FILE")),
                _ => arguments.scenes.push(word),
            }
        }
        Ok(arguments)
    }

    /// The scenes named, or `otherwise`.
    pub fn scenes(&self, otherwise: &[&str]) -> Vec<String> {
        if self.scenes.is_empty() {
            otherwise.iter().map(|&name| name.to_owned()).collect()
        } else {
            self.scenes.clone()
        }
    }

    /// The default settings with those of a verb, and then those of the command line, in their places.
    pub fn settings(&self, of_verb: &[(&str, &str)]) -> Result<Settings, String> {
        let mut settings = Settings::default();
        let given = self.set.iter().map(|(key, value)| (key.as_str(), value.as_str()));
        for (key, value) in of_verb.iter().copied().chain(given) {
            settings.set(key, value).map_err(|error| error.to_string())?;
        }
        Ok(settings)
    }

    /// The settings that the command line changes, as a line to stand above a table.
    pub fn changed(&self) -> String {
        if self.set.is_empty() {
            return "default settings".to_owned();
        }
        let pairs: Vec<_> = self.set.iter().map(|(key, value)| format!("{key}={value}")).collect();
        format!("default settings but {}", pairs.join(" "))
    }
}
