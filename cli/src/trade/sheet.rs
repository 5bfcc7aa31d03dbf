//! trade.csv: a row for each settings, kept from run to run.

use std::fs;

use crate::failure::Failure;
use crate::figures::Figures;
use crate::folder::Folder;
use crate::table::Table;
use crate::trade::sweep::Axis;

const NAME: &str = "trade.csv";

/// What a row is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    pub scene: String,
    pub reference: String,
    pub seed: u32,
    pub seeds: u32,
}

/// The table and its rows so far.
pub struct Sheet {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
    table: Option<Table>,
}

impl Sheet {
    /// Reads the rows of an earlier sweep, if there is one.
    pub fn read(folder: &Folder, axes: &[Axis]) -> Result<Self, Failure> {
        let columns = columns(axes);
        let path = folder.path().join(NAME);
        let refused = |why: String| Failure::other(format!("{}: {why}; name another folder", path.display()));
        let mut rows = Vec::new();
        if folder.names()?.iter().any(|name| name == NAME) {
            let mut bytes = fs::read(&path).map_err(|error| refused(format!("cannot be read ({})", error.kind())))?;
            // A row that lacks its end was being written when the machine stopped.
            bytes.truncate(bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1));
            let mut reader = csv::Reader::from_reader(bytes.as_slice());
            let found = reader.headers().map_err(|error| refused(error.to_string()))?;
            if found.iter().ne(columns.iter().map(String::as_str)) {
                return Err(refused("was made by a sweep of other settings".to_owned()));
            }
            for record in reader.records() {
                let record = record.map_err(|error| refused(error.to_string()))?;
                rows.push(record.iter().map(str::to_owned).collect());
            }
        }
        Ok(Self { columns, rows, table: None })
    }

    /// Whether the settings have their row already.
    pub fn has(&self, subject: &Subject, settings: &str) -> bool {
        self.of(subject).any(|row| self.cell(row, "settings") == settings)
    }

    /// Adds a row, to the file too.
    pub fn add(&mut self, folder: &Folder, row: Vec<String>) -> Result<(), Failure> {
        debug_assert_eq!(row.len(), self.columns.len());
        self.rows.push(row);
        if let Some(table) = &mut self.table {
            return table.add(&self.rows[self.rows.len() - 1]);
        }
        let all = std::iter::once(&self.columns).chain(&self.rows);
        self.table = Some(Table::create(folder, NAME, all.map(Vec::as_slice))?);
        Ok(())
    }

    /// The rows of a subject.
    pub fn of<'a>(&'a self, subject: &'a Subject) -> impl Iterator<Item = &'a Vec<String>> {
        let wanted = subject.cells();
        self.rows.iter().filter(move |row| row[..wanted.len()] == wanted)
    }

    /// A row's cell in a column.
    pub fn cell<'a>(&self, row: &'a [String], column: &str) -> &'a str {
        let index = self.columns.iter().position(|name| name == column);
        index.and_then(|index| row.get(index)).map_or("", String::as_str)
    }
}

impl Subject {
    /// The cells that a row begins with.
    pub fn cells(&self) -> [String; 4] {
        [self.scene.clone(), self.reference.clone(), self.seed.to_string(), self.seeds.to_string()]
    }
}

/// The columns' names. `X_se` stands beside each mean X.
fn columns(axes: &[Axis]) -> Vec<String> {
    let with_error = |name: &str| [name.to_owned(), format!("{name}_se")];
    let mut columns: Vec<String> = ["scene", "reference", "seed", "seeds"].map(str::to_owned).into();
    columns.extend(axes.iter().map(|axis| axis.key.clone()));
    columns.push("settings".to_owned());
    columns.extend(["cpu_s", "time_s"].iter().flat_map(|name| with_error(name)));
    columns.extend(["build_cpu_s", "build_time_s"].map(str::to_owned));
    columns.extend(Figures::NAMES.iter().flat_map(|name| with_error(name)));
    columns.extend(["cache_cells", "cache_bytes"].map(str::to_owned));
    columns
}
