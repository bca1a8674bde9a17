use super::*;
use crate::Vector3;

#[test]
fn endless_input_is_cut_off() {
    let endless = read_limited(std::io::repeat(b'v'), 1000);
    assert!(matches!(
        endless,
        Err(MeshError::FileTooLarge { allowed: 1000 })
    ));
    assert_eq!(read_limited(&[7; 1000][..], 1000).unwrap(), [7; 1000]);
}

/// Files of old programs, and of some exports, end their lines with CR alone.
#[test]
fn text_of_every_format_may_end_its_lines_with_cr() {
    let body = "cube".parse::<crate::shapes::Shape>().unwrap();
    let body = body.polyhedron(1.0).unwrap();
    let as_cr = |text: Vec<u8>| -> Vec<u8> {
        let cr = |b: u8| if b == b'\n' { b'\r' } else { b };
        text.into_iter().map(cr).collect()
    };
    let (mut obj, mut off, mut ply) = (Vec::new(), Vec::new(), Vec::new());
    obj::write(&body, &mut obj).unwrap();
    off::write(&body, &mut off).unwrap();
    ply::write(&body, &mut ply).unwrap();
    for (format, text) in [(Format::Obj, obj), (Format::Off, off), (Format::Ply, ply)] {
        let usual = parse(&text, format, &Options::default()).unwrap().0;
        let read = parse(&as_cr(text), format, &Options::default()).unwrap().0;
        assert_eq!(read.vertices(), usual.vertices(), "{format:?}");
    }
    let stl: String = body
        .triangles()
        .iter()
        .map(|t| {
            let corner = |i: &u32| {
                let p = body.vertices()[*i as usize];
                format!("vertex {} {} {}\r", p.x, p.y, p.z)
            };
            let corners: String = t.iter().map(corner).collect();
            format!("facet normal 0 0 0\router loop\r{corners}endloop\rendfacet\r")
        })
        .collect();
    let stl = format!("solid x\r{stl}endsolid x\r");
    let read = parse(stl.as_bytes(), Format::Stl, &Options::default())
        .unwrap()
        .0;
    let volume = body.mass_properties().volume;
    assert!((read.mass_properties().volume - volume).abs() < 1e-12);

    let mesh = crate::TetMesh::block([1, 2, 1], &Vector3::new(1.0, 1.0, 1.0)).unwrap();
    let (comment, mut text) = (&b"$Comments\nx\n$EndComments\n"[..], Vec::new());
    msh::write(&mesh, &mut text).unwrap();
    // The format comes first.
    let cut = text.windows(7).position(|w| w == b"$Nodes\n").unwrap();
    let msh = [&text[..cut], comment, &text[cut..]].concat();
    let read = msh::parse(&as_cr(msh)).unwrap();
    assert_eq!(read.points(), mesh.points());
}
