//! The rows that no other row beats in both cost and error.

/// Indices of the non-dominated points (cost, error), by rising cost. Of equal points the first stays; NaN never does.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<_> = (0..points.len()).filter(|&i| !points[i].0.is_nan() && !points[i].1.is_nan()).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].1 < least;
        least = least.min(points[i].1);
        better
    });
    order
}

/// Lines of cells under each other, the first as a heading; numbers stay as they are.
pub fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<_> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dominated_rows_are_left_out() {
        let points =
            [(4.0, 0.1), (1.0, 0.9), (2.0, 0.9), (3.0, 0.2), (3.0, 0.3), (5.0, 0.1), (1.0, 0.9), (f64::NAN, 0.0)];
        assert_eq!(front(&points), [1, 3, 0]);
        assert_eq!(front(&[]), [0; 0]);
        // Brute force: a point is on the front if nothing is at least as good in both and better in one.
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            f64::from(state >> 28)
        };
        let points: Vec<_> = (0..60).map(|_| (next(), next())).collect();
        let found = front(&points);
        for (i, p) in points.iter().enumerate() {
            let beaten = points.iter().any(|q| q.0 <= p.0 && q.1 <= p.1 && (q.0 < p.0 || q.1 < p.1));
            let shown = found.iter().any(|&j| points[j] == *p);
            assert_eq!(shown, !beaten, "{i} {p:?}");
        }
    }
}
