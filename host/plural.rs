//! Counts with their nouns.

/// A count with its noun, singular or plural: "1 atom", "2 atoms".
#[must_use]
pub fn count_of(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

/// What a world holds: "1 sphere", or "2 spheres, 1 other shape".
#[must_use]
pub fn contents_of(spheres: usize, shapes: usize) -> String {
    let spheres = count_of(spheres, "sphere");
    match shapes {
        0 => spheres,
        _ => format!("{spheres}, {}", count_of(shapes, "other shape")),
    }
}

#[cfg(test)]
mod tests {
    use super::count_of;

    #[test]
    fn one_is_singular() {
        let counts = [0, 1, 2].map(|count| count_of(count, "atom"));
        assert_eq!(counts, ["0 atoms", "1 atom", "2 atoms"]);
    }
}
