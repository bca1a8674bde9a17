//! Materials of the bodies and walls of a pack, and the laws of their pairs.

use std::collections::BTreeSet;

use femdem_contact::MaterialId;
use femdem_pack::PackSpec;

use super::Scene;
use crate::Error;
use crate::error::wrong;

impl Scene {
    /// The names of the materials in order, which number them from 1 on.
    fn materials(&self) -> Vec<&String> {
        let names: BTreeSet<&String> = self.material.iter().chain(&self.wall_material).collect();
        names.into_iter().collect()
    }

    /// The number of a material.
    fn material_number(&self, name: &String) -> Result<MaterialId, Error> {
        let names = self.materials();
        let Ok(place) = names.binary_search(&name) else {
            let names: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
            return Err(Error::Unknown {
                name: "materials",
                value: name.clone(),
                known: format!(
                    "the names in material and wall-material: {}",
                    names.join(", ")
                ),
            });
        };
        u8::try_from(place + 1).map(MaterialId).map_err(|_| {
            let count = names.len().to_string();
            wrong("material", &count, "at most 255 materials")
        })
    }

    /// The material of the shape with this number.
    pub(super) fn material_of(&self, entry: usize) -> Result<MaterialId, Error> {
        let name = match self.material.len() {
            0 => return Ok(MaterialId::default()),
            1 => &self.material[0],
            count if count == self.shape.len() => &self.material[entry],
            count => {
                let allowed = "one name for all shapes, or one for each shape";
                return Err(wrong("material", &format!("{count} names"), allowed));
            }
        };
        self.material_number(name)
    }

    /// Gives a job the material of its walls and the laws of pairs.
    pub(super) fn set_materials(&self, spec: &mut PackSpec) -> Result<(), Error> {
        spec.materials = self.materials().into_iter().cloned().collect();
        if let Some(name) = &self.wall_material {
            spec.wall_material = self.material_number(name)?;
        }
        if !spec.materials.is_empty() && self.pair.is_empty() {
            let allowed = "with a [[pair]] that names them: else they have no effect";
            return Err(wrong("material", "given", allowed));
        }
        let mut known = BTreeSet::new();
        for pair in &self.pair {
            let [a, b] = &pair.materials;
            let ids = [self.material_number(a)?, self.material_number(b)?];
            if pair.wall_response.is_some() {
                let allowed = "for deformable bodies only, and a pack has none: leave it out";
                return Err(wrong("wall-response", "given in [[pair]]", allowed));
            }
            pair.check(&mut known)?;
            spec.pairs.push(pair.own(ids));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::Scene;
    use femdem_contact::MaterialId;

    const MIXTURE: &str = "shape = [\"P5\", \"A10\"]\nmaterial = [\"steel\", \"ice\"]\n\
        wall-material = \"wood\"\ncohesion = 20\n\
        [[pair]]\nmaterials = [\"wood\", \"steel\"]\nfriction = 0.1\n\
        [[pair]]\nmaterials = [\"ice\", \"ice\"]\ncohesion = 300\n";

    #[test]
    fn shapes_and_walls_have_materials_and_pairs_laws() {
        let scene = Scene::from_toml(MIXTURE).unwrap();
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
        let spec = scene.spec().unwrap();
        let [ice, steel, wood] = [1, 2, 3].map(MaterialId);
        assert_eq!(spec.materials, ["ice", "steel", "wood"]);
        assert_eq!(spec.wall_material, wood);
        let of_shapes: Vec<MaterialId> = spec.shapes.iter().map(|s| s.material).collect();
        assert_eq!(of_shapes, [steel, ice]);
        let (packing, _) = scene.packing().unwrap();
        let world = packing.world();
        let laws = world.laws();
        assert_eq!(laws.between([wood, steel]).friction, 0.1);
        assert_eq!(laws.between([ice, ice]).cohesion, 300.0);
        assert_eq!(laws.between([ice, steel]).cohesion, 20.0);
        assert_eq!(laws.between([ice, ice]).penalty, packing.penalty());
        assert_eq!(world.wall_material(0), Some(wood));
        assert_eq!(spec.usual_step(), None);
    }

    #[test]
    fn materials_that_mean_nothing_are_refused() {
        for (from, to, words) in [
            (
                "\"steel\"]\nfriction",
                "\"stone\"]\nfriction",
                "materials = \"stone\"",
            ),
            ("cohesion = 300\n", "", "the materials only"),
            (
                "cohesion = 300\n",
                "wall-response = \"rigid\"\n",
                "wall-response",
            ),
            ("[\"wood\", \"steel\"]", "[\"ice\", \"ice\"]", "given twice"),
            ("[\"steel\", \"ice\"]", "[\"a\", \"b\", \"c\"]", "3 names"),
        ] {
            assert!(MIXTURE.contains(from), "{from}");
            let scene = Scene::from_toml(&MIXTURE.replacen(from, to, 1)).unwrap();
            let message = scene.spec().unwrap_err().to_string();
            assert!(message.contains(words), "{to}: {message}");
        }
        let scene = Scene::from_toml("material = \"steel\"").unwrap();
        assert!(scene.spec().unwrap_err().to_string().contains("[[pair]]"));
    }
}
