//! The touching pairs of each body.

/// A pair, and the side of a body in it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Part {
    /// Index of the pair in the list.
    pub place: u32,
    pub side: u8,
}

/// The touching pairs of each body, in their order.
pub(crate) struct Touching {
    /// Start of the entries of each body.
    starts: Vec<u32>,
    parts: Vec<Part>,
}

impl Touching {
    /// From (body, part) in the order of the pairs; bodies are below `bodies`.
    pub fn new(all: &[(u32, Part)], bodies: usize) -> Self {
        let known = || all.iter().filter(|(body, _)| (*body as usize) < bodies);
        let mut starts = vec![0; bodies + 1];
        for (body, _) in known() {
            starts[*body as usize + 1] += 1;
        }
        for body in 0..bodies {
            starts[body + 1] += starts[body];
        }
        let mut next = starts.clone();
        let mut parts = vec![Part::default(); starts[bodies] as usize];
        for (body, part) in known() {
            let next = &mut next[*body as usize];
            parts[*next as usize] = *part;
            *next += 1;
        }
        Self { starts, parts }
    }

    pub fn of(&self, body: usize) -> &[Part] {
        &self.parts[self.starts[body] as usize..self.starts[body + 1] as usize]
    }
}
