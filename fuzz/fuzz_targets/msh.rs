//! The reader of Gmsh meshes: what it accepts survives being written and read again.

#![no_main]

use femdem_mesh::io::msh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(mesh) = msh::parse(bytes) else { return };
    let (mut new, mut old) = (Vec::new(), Vec::new());
    msh::write(&mesh, &mut new).expect("a vector takes all bytes");
    msh::write_v2(&mesh, &mut old).expect("a vector takes all bytes");
    for file in [new, old] {
        assert_eq!(msh::parse(&file).expect("written by femdem"), mesh);
    }
});
