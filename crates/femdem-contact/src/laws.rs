//! Contact laws for pairs of materials.

use crate::law::{ContactLaw, ContactParameters};
use serde::{Deserialize, Serialize};

/// Number of a material, by which a pair of bodies, or a body and a wall, find their law. 0, the default, is the material of
/// everything that was not given another.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct MaterialId(pub u8);

/// A default law, and laws of their own for pairs of materials.
///
/// ```
/// use femdem_contact::{ContactLaw, ContactLaws, ContactParameters, MaterialId};
///
/// let [steel, ice] = [1, 2].map(MaterialId);
/// let usual = ContactParameters::default();
/// let mut laws = ContactLaws::from(ContactLaw::new(usual)?);
/// laws.set([steel, ice], Some(ContactLaw::new(ContactParameters { friction: 0.02, ..usual })?));
/// assert_eq!(laws.between([ice, steel]).friction, 0.02);
/// assert_eq!(laws.between([ice, ice]), &usual);
/// # Ok::<(), femdem_contact::ContactError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactLaws {
    usual: ContactLaw,
    /// The rows of a triangle: those of material 0, of materials 0 and 1 with 1, and so on. `None`: the default.
    pairs: Vec<Option<ContactLaw>>,
}

impl From<ContactLaw> for ContactLaws {
    fn from(usual: ContactLaw) -> Self {
        Self {
            usual,
            pairs: Vec::new(),
        }
    }
}

/// Laws before the first in the row of a material.
fn before(material: usize) -> usize {
    material * (material + 1) / 2
}

/// Where the law of two materials is, in either order.
fn place([a, b]: [MaterialId; 2]) -> usize {
    before(usize::from(a.0.max(b.0))) + usize::from(a.0.min(b.0))
}

impl ContactLaws {
    /// The parameters of the law of two materials, in either order.
    #[inline]
    pub fn between(&self, materials: [MaterialId; 2]) -> &ContactParameters {
        let own = self.pairs.get(place(materials)).and_then(Option::as_ref);
        own.unwrap_or(&self.usual).parameters()
    }

    /// Gives two materials, or a material and itself, a law of their own; `None`: the default again.
    pub fn set(&mut self, materials: [MaterialId; 2], law: Option<ContactLaw>) {
        if law.is_some() {
            let rows = usize::from(materials[0].0.max(materials[1].0)) + 1;
            self.pairs.resize(self.pairs.len().max(before(rows)), None);
        }
        if let Some(own) = self.pairs.get_mut(place(materials)) {
            *own = law;
        }
    }

    /// The parameters of the default law.
    pub fn usual(&self) -> &ContactParameters {
        self.usual.parameters()
    }

    /// The same laws of pairs with another default.
    #[must_use]
    pub fn with_usual(self, usual: ContactLaw) -> Self {
        Self { usual, ..self }
    }

    /// The same laws where the materials have other numbers: that of material k is `numbers[k]`. Laws of materials beyond the list
    /// are left out.
    #[must_use]
    pub fn renumbered(&self, numbers: &[MaterialId]) -> Self {
        let mut laws = Self::from(self.usual);
        for (a, &new_a) in numbers.iter().enumerate() {
            for (b, &new_b) in numbers[..=a].iter().enumerate() {
                let own = self.pairs.get(before(a) + b).copied().flatten();
                if own.is_some() {
                    laws.set([new_a, new_b], own);
                }
            }
        }
        laws
    }

    /// The default law, and all laws of pairs with a material: a bound over them holds whatever it meets.
    pub fn of(&self, material: MaterialId) -> impl Iterator<Item = &ContactParameters> {
        let known = (0..=u8::MAX).take_while(|k| before(usize::from(*k)) < self.pairs.len());
        let with = move |k| self.pairs.get(place([MaterialId(k), material]))?.as_ref();
        std::iter::once(self.usual()).chain(known.filter_map(with).map(ContactLaw::parameters))
    }

    /// All laws, the default first.
    pub fn all(&self) -> impl Iterator<Item = &ContactParameters> {
        let own = self.pairs.iter().flatten().map(ContactLaw::parameters);
        std::iter::once(self.usual()).chain(own)
    }

    /// The largest gap over which bodies attract each other by any law, m.
    pub fn attraction_range(&self) -> f64 {
        self.all()
            .map(ContactParameters::attraction_range)
            .fold(0.0, f64::max)
    }

    /// The same laws without dashpots: springs and friction alone.
    #[must_use]
    pub fn without_dashpots(self) -> Self {
        Self {
            usual: self.usual.without_dashpots(),
            pairs: self
                .pairs
                .into_iter()
                .map(|law| law.map(ContactLaw::without_dashpots))
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(friction: f64) -> ContactLaw {
        ContactLaw::new(ContactParameters {
            friction,
            ..ContactParameters::default()
        })
        .unwrap()
    }

    /// Each pair of many has its own law, found in either order, and the law of a pair that was never set, or was set back, is
    /// the default, also a new one.
    #[test]
    fn each_pair_has_its_law() {
        let ids = [0, 1, 2, 3, 7, 254, 255].map(MaterialId);
        let mut laws = ContactLaws::from(law(9.0));
        let mut friction = 0.0;
        for (i, &a) in ids.iter().enumerate() {
            for &b in &ids[..=i] {
                friction += 0.01;
                laws.set([b, a], Some(law(friction)));
            }
        }
        friction = 0.0;
        for (i, &a) in ids.iter().enumerate() {
            for &b in &ids[..=i] {
                friction += 0.01;
                assert_eq!(laws.between([a, b]).friction, friction);
                assert_eq!(laws.between([b, a]).friction, friction);
            }
        }
        assert_eq!(laws.between([MaterialId(5), ids[4]]).friction, 9.0);
        laws.set([ids[3], ids[5]], None);
        let laws = laws.with_usual(law(8.0));
        assert_eq!(laws.between([ids[5], ids[3]]).friction, 8.0);
        // The default, and those of material 3 with the others but 254.
        assert_eq!(laws.of(ids[3]).count(), 1 + ids.len() - 1);
        assert_eq!(laws.of(MaterialId(5)).count(), 1);
        assert_eq!(laws.all().count(), 1 + 7 * 8 / 2 - 1);
    }

    #[test]
    fn a_law_without_a_table_is_that_of_all() {
        let mut laws = ContactLaws::from(law(0.3));
        laws.set([MaterialId(4), MaterialId(9)], None);
        assert_eq!(laws, ContactLaws::from(law(0.3)));
        for k in [0, 4, 255].map(MaterialId) {
            assert_eq!(laws.between([k, MaterialId(9)]).friction, 0.3);
            assert_eq!(laws.of(k).count(), 1);
        }
    }
}
