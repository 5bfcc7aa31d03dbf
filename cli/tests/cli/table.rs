//! Reads the command's tables.

use crate::place::Place;

/// A CSV file.
pub struct Table {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub fn read(place: &Place, name: &str) -> Self {
        let mut reader = csv::Reader::from_path(place.path(name)).expect("a table");
        let owned = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
        let columns = owned(reader.headers().expect("columns"));
        Self { columns, rows: reader.records().map(|record| owned(&record.expect("a row"))).collect() }
    }

    pub fn text(&self, row: usize, column: &str) -> &str {
        let index = self.columns.iter().position(|name| name == column);
        &self.rows[row][index.unwrap_or_else(|| panic!("no column {column}"))]
    }

    /// The number in a cell; `None` for an empty one.
    pub fn number(&self, row: usize, column: &str) -> Option<f64> {
        Some(self.text(row, column)).filter(|text| !text.is_empty()).map(|text| text.parse().expect("a number"))
    }
}
