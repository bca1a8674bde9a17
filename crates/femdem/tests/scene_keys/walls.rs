//! Walls with every field written out.

use super::{SHAKE, V, control};
use femdem::run::{
    BoxEntry, ConeEntry, CylinderEntry, Ends, HopperEntry, PlaneEntry, PlateEntry, SiloEntry,
    WallEntry,
};
use femdem::scene::Unit;
use std::path::PathBuf;

pub(super) fn plane() -> PlaneEntry {
    PlaneEntry {
        normal: V,
        offset: 1.0,
    }
}

pub(super) fn space() -> BoxEntry {
    BoxEntry {
        lower: V,
        upper: V,
        open: true,
    }
}

pub(super) fn cylinder() -> CylinderEntry {
    CylinderEntry {
        diameter: 1.0,
        from: Some(V),
        to: Some(V),
        ends: Ends::To,
        thickness: Some(1.0),
        facets: 8,
    }
}

pub(super) fn cone() -> ConeEntry {
    ConeEntry {
        diameters: [1.0, 2.0],
        from: V,
        to: V,
        ends: Ends::Both,
        thickness: Some(1.0),
        facets: 8,
    }
}

pub(super) fn silo() -> SiloEntry {
    SiloEntry {
        diameter: 1.0,
        height: 1.0,
        outlet: 0.5,
        half_angle: 45.0,
        position: V,
        thickness: Some(1.0),
        facets: 8,
    }
}

pub(super) fn plate() -> PlateEntry {
    PlateEntry {
        diameter: 1.0,
        centre: V,
        normal: V,
        thickness: Some(1.0),
        facets: 8,
    }
}

pub(super) fn hopper() -> HopperEntry {
    HopperEntry {
        section: [1.0, 1.0],
        outlet: [0.5, 0.5],
        half_angle: 1.0,
        height: 1.0,
        position: V,
        thickness: Some(1.0),
    }
}

pub(super) fn wall() -> WallEntry {
    WallEntry {
        name: "w".to_owned(),
        plane: Some(plane()),
        r#box: Some(space()),
        cylinder: Some(cylinder()),
        cone: Some(cone()),
        silo: Some(silo()),
        hopper: Some(hopper()),
        plate: Some(plate()),
        file: Some(PathBuf::from("w.stl")),
        unit: Unit::M,
        repair: true,
        material: Some("m".to_owned()),
        motion: Some(SHAKE),
        control: Some(control()),
        opens: Some(1.0),
    }
}
