//! The sections of a file: format, nodes, elements.

use super::elements::{Use, usage};
use super::values::{Encoding, Values};
use crate::io::text::shortened;
use crate::{MeshError, Point3};

/// Nodes and tetrahedra as in the file.
#[derive(Default)]
pub(super) struct Contents {
    /// Tags, which may be any numbers, and positions.
    nodes: Vec<(u64, Point3)>,
    /// Tags of the corners.
    tets: Vec<[u64; 4]>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Contents, MeshError> {
    let mut values = Values::new(bytes);
    let first = values.word();
    if first != Some(b"$MeshFormat") {
        return Err(MeshError::Empty {
            what: "Gmsh mesh: it does not start with $MeshFormat",
        });
    }
    let version = format(&mut values)?;
    let mut contents = Contents::default();
    while let Some(word) = values.word() {
        let Some(name) = word.strip_prefix(b"$") else {
            let what = format!("\"{}\" stands outside all sections", shortened(word));
            return Err(values.problem(what));
        };
        values.end_line();
        match (name, version) {
            (b"Nodes", Version::V41) => contents.nodes_v4(&mut values)?,
            (b"Nodes", Version::V22) => contents.nodes_v2(&mut values)?,
            (b"Elements", Version::V41) => contents.elements_v4(&mut values)?,
            (b"Elements", Version::V22) => contents.elements_v2(&mut values)?,
            _ => {}
        }
        end(name, &mut values)?;
    }
    Ok(contents)
}

#[derive(Clone, Copy, PartialEq)]
enum Version {
    V41,
    V22,
}

/// Reads the section of the format and determines the encoding of numbers.
fn format(values: &mut Values) -> Result<Version, MeshError> {
    let name = values.word().unwrap_or_default();
    let version = match name {
        b"4.1" => Version::V41,
        b"2.2" | b"2.1" | b"2.0" | b"2" => Version::V22,
        _ => {
            return Err(MeshError::Unsupported {
                what: format!("the Gmsh format \"{}\"", shortened(name)),
                advice: "save it in format 4.1 or 2.2",
            });
        }
    };
    let (binary, size) = (values.int()?, values.int()?);
    values.end_line();
    if binary == 1 {
        if version != Version::V41 || size != 8 {
            return Err(MeshError::Unsupported {
                what: "binary data of another format than 4.1 with sizes of 8 bytes".to_owned(),
                advice: "save it in format 4.1, or as ASCII",
            });
        }
        // The number 1 shows the byte order.
        values.encoding = Encoding::LittleEndian;
        if values.int()? != 1 {
            values.encoding = Encoding::BigEndian;
        }
    } else if binary != 0 {
        return Err(values.problem("the file type must be 0 (ASCII) or 1 (binary)"));
    }
    end(b"MeshFormat", values)?;
    Ok(version)
}

/// Continues after the end of a section.
fn end(name: &[u8], values: &mut Values) -> Result<(), MeshError> {
    let mark = [b"$End", name].concat();
    if values.pass(&mark) {
        return Ok(());
    }
    let what = format!("there is no {}: the file is cut off", shortened(&mark));
    Err(values.problem(what))
}

impl Contents {
    fn nodes_v4(&mut self, values: &mut Values) -> Result<(), MeshError> {
        let (blocks, _nodes, _min, _max) = header(values)?;
        for _ in 0..blocks {
            let (dimension, _entity, parametric) = (values.int()?, values.int()?, values.int()?);
            let count = values.size()?;
            let mut tags = Vec::new();
            for _ in 0..count {
                tags.push(values.size()?);
            }
            let parameters = if parametric == 0 {
                0
            } else {
                dimension.clamp(0, 3)
            };
            for tag in tags {
                self.nodes.push((tag, place(values)?));
                for _ in 0..parameters {
                    values.real()?;
                }
            }
        }
        Ok(())
    }

    fn nodes_v2(&mut self, values: &mut Values) -> Result<(), MeshError> {
        for _ in 0..values.size()? {
            let tag = values.size()?;
            self.nodes.push((tag, place(values)?));
        }
        Ok(())
    }

    fn elements_v4(&mut self, values: &mut Values) -> Result<(), MeshError> {
        let (blocks, _elements, _min, _max) = header(values)?;
        for _ in 0..blocks {
            let (_dimension, _entity, code) = (values.int()?, values.int()?, values.int()?);
            let count = values.size()?;
            if count == 0 {
                continue;
            }
            let usage = usage(code)?;
            for _ in 0..count {
                let _tag = values.size()?;
                self.element(usage, values)?;
            }
        }
        Ok(())
    }

    fn elements_v2(&mut self, values: &mut Values) -> Result<(), MeshError> {
        for _ in 0..values.size()? {
            let (_tag, code) = (values.size()?, values.int()?);
            for _ in 0..values.size()? {
                values.int()?;
            }
            self.element(usage(code)?, values)?;
        }
        Ok(())
    }

    fn element(&mut self, usage: Use, values: &mut Values) -> Result<(), MeshError> {
        match usage {
            Use::Read => {
                let mut tet = [0; 4];
                for corner in &mut tet {
                    *corner = values.size()?;
                }
                self.tets.push(tet);
            }
            Use::Skip(nodes) => {
                for _ in 0..nodes {
                    values.size()?;
                }
            }
        }
        Ok(())
    }

    /// The points used by tetrahedra, in the order of the file, and tetrahedra of positive volume.
    pub(super) fn tetrahedra(self) -> Result<(Vec<Point3>, Vec<[u32; 4]>), MeshError> {
        let Self { nodes, tets } = self;
        if tets.is_empty() {
            return Err(MeshError::Empty { what: "tetrahedra" });
        }
        let mut by_tag: Vec<(u64, usize)> = nodes.iter().map(|node| node.0).zip(0..).collect();
        by_tag.sort_unstable();
        if let Some(pair) = by_tag.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(MeshError::NodeTag {
                tag: pair[0].0,
                problem: "is given twice",
            });
        }
        let find = |tag: u64| {
            let at = by_tag.binary_search_by_key(&tag, |&(tag, _)| tag);
            at.map(|at| by_tag[at].1).map_err(|_| MeshError::NodeTag {
                tag,
                problem: "is named by a tetrahedron, but not among the nodes",
            })
        };
        let mut corners = Vec::with_capacity(tets.len());
        let mut used = vec![false; nodes.len()];
        for tet in tets {
            let [a, b, c, d] = tet;
            let tet = [find(a)?, find(b)?, find(c)?, find(d)?];
            tet.iter().for_each(|&i| used[i] = true);
            corners.push(tet);
        }
        let mut new_index = vec![0; nodes.len()];
        let mut points: Vec<Point3> = Vec::new();
        for (i, (_, point)) in nodes.iter().enumerate() {
            if used[i] {
                new_index[i] = points.len() as u32;
                points.push(*point);
            }
        }
        let tets = corners.into_iter().map(|tet| {
            let at = tet.map(|i| nodes[i].1);
            let [a, b, c, d] = tet.map(|i| new_index[i]);
            let volume = (at[1] - at[0]).dot(&(at[2] - at[0]).cross(&(at[3] - at[0])));
            if volume < 0.0 {
                [a, b, d, c]
            } else {
                [a, b, c, d]
            }
        });
        Ok((points, tets.collect()))
    }
}

/// Number of blocks, of items, and the range of tags.
fn header(values: &mut Values) -> Result<(u64, u64, u64, u64), MeshError> {
    Ok((
        values.size()?,
        values.size()?,
        values.size()?,
        values.size()?,
    ))
}

fn place(values: &mut Values) -> Result<Point3, MeshError> {
    Ok(Point3::new(values.real()?, values.real()?, values.real()?))
}
