use std::fmt;

/// How many facets a message names.
const NAMED: usize = 8;

/// Facets at fault: the first few, and their number.
///
/// Facets count from 0 in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FacetList {
    /// The first of the facets, in order; at most eight.
    pub first: Vec<usize>,
    /// How many facets there are.
    pub count: usize,
}

impl FacetList {
    /// A list of facets given in any order, possibly repeated.
    pub(crate) fn of(facets: impl IntoIterator<Item = usize>) -> Self {
        let mut first: Vec<usize> = facets.into_iter().collect();
        first.sort_unstable();
        first.dedup();
        let count = first.len();
        first.truncate(NAMED);
        Self { first, count }
    }

    /// One of two texts, for one facet or several.
    pub(crate) fn one_or_more<'a>(&self, one: &'a str, more: &'a str) -> &'a str {
        if self.count == 1 { one } else { more }
    }
}

impl fmt::Display for FacetList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let more = self.count - self.first.len().min(self.count);
        write!(f, "{}", self.one_or_more("facet", "facets"))?;
        for (i, facet) in self.first.iter().enumerate() {
            let last = i > 0 && i + 1 == self.first.len() && more == 0;
            let before = match i {
                0 => " ",
                _ if last => " and ",
                _ => ", ",
            };
            write!(f, "{before}{facet}")?;
        }
        match more {
            0 => Ok(()),
            _ => write!(f, " and {more} more"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_few_are_named() {
        let says = |facets: &[usize]| FacetList::of(facets.iter().copied()).to_string();
        assert_eq!(says(&[5, 5]), "facet 5");
        assert_eq!(says(&[7, 5]), "facets 5 and 7");
        assert_eq!(says(&[7, 5, 6]), "facets 5, 6 and 7");
        let many: Vec<usize> = (0..20).collect();
        assert_eq!(says(&many), "facets 0, 1, 2, 3, 4, 5, 6, 7 and 12 more");
    }
}
