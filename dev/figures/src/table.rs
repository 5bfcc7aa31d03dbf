//! Markdown tables, row by row as figures come in.

/// Prints a table's head.
pub fn head(columns: &[&str]) {
    row(columns);
    println!("|{}", "---|".repeat(columns.len()));
}

/// Prints a row.
pub fn row<T: AsRef<str>>(cells: &[T]) {
    let cells: Vec<&str> = cells.iter().map(AsRef::as_ref).collect();
    println!("| {} |", cells.join(" | "));
}

/// An error with four digits that count.
pub fn error(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 { format!("{value:.3e}") } else { format!("{value:.4}") }
}

/// Seconds.
pub fn seconds(value: f64) -> String {
    format!("{value:.3}")
}

/// A ratio.
pub fn ratio(value: f64) -> String {
    format!("{value:.2}")
}
