//! Averages over nodes: the volume ratio of a node is that of the tetrahedra around it, and that of a
//! tetrahedron the mean over its four nodes. A node between regions has a separate average for each.

use std::collections::BTreeMap;

/// Which tetrahedra share an average.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NodalAverages {
    /// The averages that each tetrahedron contributes to: one per corner.
    pub of: Vec<[u32; 4]>,
    /// Volume of the tetrahedra of each average, m^3.
    pub volumes: Vec<f64>,
}

impl NodalAverages {
    pub fn new(tets: &[[u32; 4]], region_of: &[u32], volumes: &[f64]) -> Self {
        let mut known = BTreeMap::new();
        let mut sums: Vec<f64> = Vec::new();
        let of = tets
            .iter()
            .zip(region_of)
            .zip(volumes)
            .map(|((tet, &region), &volume)| {
                tet.map(|node| {
                    let average = *known.entry((node, region)).or_insert_with(|| {
                        sums.push(0.0);
                        sums.len() - 1
                    });
                    sums[average] += volume;
                    average as u32
                })
            })
            .collect();
        Self { of, volumes: sums }
    }

    /// Per average the mean of a value per tetrahedron, weighted by volume.
    pub fn of_nodes(&self, volumes: &[f64], values: &[f64]) -> Vec<f64> {
        let mut means = vec![0.0; self.volumes.len()];
        for ((averages, volume), value) in self.of.iter().zip(volumes).zip(values) {
            for &n in averages {
                means[n as usize] += volume * value;
            }
        }
        for (mean, volume) in means.iter_mut().zip(&self.volumes) {
            *mean /= volume;
        }
        means
    }

    /// Mean of a tetrahedron's four averages.
    pub fn of_tet(&self, tet: usize, nodal: &[f64]) -> f64 {
        let [a, b, c, d] = self.of[tet].map(|n| nodal[n as usize]);
        0.25 * (a + b + c + d)
    }

    /// A value per tetrahedron averaged to the nodes and back.
    pub fn smoothed(&self, volumes: &[f64], values: &[f64]) -> Vec<f64> {
        let nodal = self.of_nodes(volumes, values);
        (0..values.len()).map(|e| self.of_tet(e, &nodal)).collect()
    }
}
