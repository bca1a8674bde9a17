use std::fmt;

/// Changes made to the facets of a file to form a body.
///
/// `Display` writes one sentence per line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Report {
    /// Vertices in the file.
    pub vertices: usize,
    /// Facets in the file.
    pub facets: usize,
    /// Vertices that no facet used.
    pub vertices_unused: usize,
    /// Vertices that were joined to another at the same place.
    pub vertices_welded: usize,
    /// Facets whose loop was reversed so that neighbours look to the same side.
    pub facets_flipped: usize,
    /// Whether all facets were then reversed to look outward.
    pub turned_outward: bool,
    /// Facets without area that were dropped (repair).
    pub facets_without_area: usize,
    /// Copies of other facets that were dropped (repair).
    pub facets_given_twice: usize,
    /// Vertices that lay on the edge of another facet and were inserted into it (repair).
    pub seams_joined: usize,
    /// Facets cut into triangles, because they were not planar or had a vertex inserted (repair).
    pub facets_split: usize,
}

impl Report {
    pub(super) fn new(vertices: usize, facets: usize) -> Self {
        Self {
            vertices,
            facets,
            ..Self::default()
        }
    }

    /// Whether facets were changed, dropped or reversed. Joining vertices at the same place and dropping unused
    /// ones does not count as a change.
    pub fn is_changed(&self) -> bool {
        self.turned_outward
            || [
                self.facets_flipped,
                self.facets_without_area,
                self.facets_given_twice,
                self.seams_joined,
                self.facets_split,
            ]
            .iter()
            .any(|&n| n > 0)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} facets, {} vertices read", self.facets, self.vertices)?;
        let lines = [
            (self.vertices_unused, "vertices dropped that no facet uses"),
            (
                self.vertices_welded,
                "vertices joined to another at the same place",
            ),
            (self.facets_without_area, "facets without area dropped"),
            (self.facets_given_twice, "facets given twice dropped"),
            (
                self.seams_joined,
                "vertices on edges of other facets joined to them",
            ),
            (self.facets_split, "facets cut into triangles"),
            (
                self.facets_flipped,
                "facets turned round to agree with their neighbours",
            ),
        ];
        for (count, what) in lines {
            if count > 0 {
                write!(f, "\n{count} {what}")?;
            }
        }
        if self.turned_outward {
            write!(f, "\nthe surface was inside out and has been turned")?;
        }
        Ok(())
    }
}
