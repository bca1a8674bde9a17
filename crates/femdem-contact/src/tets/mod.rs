//! Tetrahedra with a field that is linear in each: what the kernels of rigid and of deformable meshes share.
//!
//! Two meshes meet in two ways, which give the same integrals: by the polygons in which the skin of one lies in the
//! tetrahedra of the other ([`clip`]), and by the common parts of their tetrahedra ([`pieces`]).

pub(crate) mod boxes;
pub(crate) mod cells;
pub(crate) mod clip;
pub(crate) mod current;
pub(crate) mod near_list;
pub(crate) mod piece;
pub(crate) mod pieces;
pub(crate) mod polygon;
pub(crate) mod posed;
pub(crate) mod row;
pub(crate) mod skins;
