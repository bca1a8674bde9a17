use crate::repair::FacetList;
use std::path::PathBuf;

/// Everything that can be wrong with a surface, a shape's name or a surface file.
///
/// Messages name the offending indices and values, the allowed range, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is ({x}, {y}, {z}): coordinates must be finite numbers")]
    NotFinite {
        /// Index of the vertex or point.
        vertex: usize,
        /// Its x coordinate \[m\].
        x: f64,
        /// Its y coordinate \[m\].
        y: f64,
        /// Its z coordinate \[m\].
        z: f64,
    },
    /// The bounding box is too small or too large for the arithmetic.
    #[error(
        "the bounding box has a diagonal of {extent:e} m; allowed are 1e-30 to 1e30 m: \
         change the unit of length"
    )]
    Size {
        /// Diagonal of the bounding box \[m\].
        extent: f64,
    },
    /// The body is so far from the origin that its coordinates have too few digits left for its shape.
    #[error(
        "the body has a diagonal of {extent:e} m but lies {distance:e} m from the origin, where \
         coordinates hold too few digits (the diagonal must exceed 1e-9 of the distance): \
         move it nearer to the origin"
    )]
    TooFarFromOrigin {
        /// Diagonal of the bounding box \[m\].
        extent: f64,
        /// Largest coordinate by magnitude \[m\].
        distance: f64,
    },
    /// A closed surface needs at least four vertices and four faces.
    #[error(
        "{vertices} vertices and {faces} faces: a closed surface needs at least 4 vertices and 4 faces"
    )]
    TooFew {
        /// Number of vertices given.
        vertices: usize,
        /// Number of faces given.
        faces: usize,
    },
    /// The surface has more vertices or face corners than 32-bit indices can name.
    #[error("{count} {what}: at most {allowed} are supported")]
    TooMany {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are allowed.
        allowed: usize,
    },
    /// A face has fewer than three vertices.
    #[error("face {face} has {count} vertices: a face needs at least 3")]
    FaceTooShort {
        /// Index of the face.
        face: usize,
        /// Number of its vertices.
        count: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but there are only {count} vertices (0 to {})", count.saturating_sub(1))]
    IndexOutOfRange {
        /// Index of the face.
        face: usize,
        /// The index it names.
        index: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A face visits a vertex twice.
    #[error("face {face} visits vertex {vertex} more than once: split it into simple polygons")]
    RepeatedVertex {
        /// Index of the face.
        face: usize,
        /// The repeated vertex.
        vertex: u32,
    },
    /// A vertex belongs to no face.
    #[error("vertex {vertex} belongs to no face: remove it")]
    UnreferencedVertex {
        /// Index of the vertex.
        vertex: usize,
    },
    /// An edge has a face on one side only.
    #[error(
        "the surface is open: the edge from vertex {from} to {to} of face {face} has no second \
         face: close the hole (or weld vertices that lie at the same place)"
    )]
    OpenEdge {
        /// First vertex of the edge.
        from: u32,
        /// Second vertex of the edge.
        to: u32,
        /// The face that contains it.
        face: usize,
    },
    /// Two neighbours run along their common edge in the same direction.
    #[error(
        "faces {first} and {second} both run from vertex {from} to {to}: their orientations \
         disagree; reverse the vertex loop of one of them"
    )]
    InconsistentOrientation {
        /// First vertex of the edge.
        from: u32,
        /// Second vertex of the edge.
        to: u32,
        /// One face.
        first: usize,
        /// The other face.
        second: usize,
    },
    /// More than two faces meet at an edge.
    #[error("{count} faces share the edge between vertices {from} and {to}: exactly 2 must")]
    NonManifoldEdge {
        /// One end of the edge.
        from: u32,
        /// The other end.
        to: u32,
        /// Number of faces that use it.
        count: usize,
    },
    /// Parts of the surface touch at a single vertex only.
    #[error(
        "{fans} separate fans of faces meet at vertex {vertex}: give each its own copy of the vertex"
    )]
    NonManifoldVertex {
        /// Index of the vertex.
        vertex: usize,
        /// Number of fans of faces.
        fans: usize,
    },
    /// The surface is several closed surfaces, none inside another.
    #[error(
        "the surface has {components} separate closed shells: a body must be one; join them into one \
         surface (a union), or give each as a body of its own"
    )]
    Disconnected {
        /// Number of closed shells.
        components: usize,
    },
    /// The surface is several closed surfaces, and one lies inside another.
    #[error(
        "the surface is hollow: it has {shells} closed shells, and that of face {face} lies inside \
         another: bodies with closed hollows are not supported; leave the inner shells out, and lower \
         the density if the mass is to be that of the hollow body"
    )]
    Hollow {
        /// Number of closed shells.
        shells: usize,
        /// A face of a shell that lies inside another.
        face: usize,
    },
    /// The surface is several closed surfaces that share facets, edges or vertices.
    #[error(
        "the surface has {shells} closed shells that touch at {facets}: a body must be one; join them \
         into one surface (a union), or give each as a body of its own"
    )]
    Touching {
        /// Number of closed shells, by the vertex numbers of the file.
        shells: usize,
        /// Facets there.
        facets: FacetList,
    },
    /// A face has no area.
    #[error(
        "face {face} has an area of {area:e} m^2, which is zero to rounding: remove it, \
         or move its vertices apart"
    )]
    DegenerateFace {
        /// Index of the face.
        face: usize,
        /// Its area \[m^2\].
        area: f64,
    },
    /// The vertices of a face do not lie in one plane.
    #[error(
        "face {face} is not planar: vertex {vertex} lies {distance:e} m off its plane, allowed are \
         {allowed:e} m: split the face into triangles"
    )]
    NotPlanar {
        /// Index of the face.
        face: usize,
        /// The vertex farthest from the plane.
        vertex: u32,
        /// Its distance from the plane \[m\].
        distance: f64,
        /// Largest distance allowed \[m\].
        allowed: f64,
    },
    /// The faces look inwards.
    #[error(
        "the surface is inside out (its volume is {volume:e} by its coordinates): reverse the vertex loop of every \
         face, so that loops run counter-clockwise seen from outside, or ask for repair"
    )]
    InsideOut {
        /// The signed volume \[m^3\].
        volume: f64,
    },
    /// The surface encloses no volume.
    #[error(
        "the surface encloses a volume of {volume:e} by its coordinates, which is zero to rounding: move its vertices apart"
    )]
    NoVolume {
        /// The signed volume \[m^3\].
        volume: f64,
    },
    /// Facets have a side that no other facet has.
    #[error(
        "the surface is open: {edges} sides of {facets} have no second facet: close the holes (or \
         weld or repair, if neighbours do not quite meet)"
    )]
    OpenSurface {
        /// Number of sides with one facet.
        edges: usize,
        /// The facets that contain them.
        facets: FacetList,
    },
    /// More than two facets meet at an edge, or a vertex joins parts that meet nowhere else.
    #[error(
        "the surface is not manifold: {facets} share an edge or vertex that must have {}: remove \
         facets inside the body, or separate parts that touch",
        if *.what == "vertex" { "one fan of facets" } else { "2 facets" }
    )]
    NonManifoldFacets {
        /// "edge" or "vertex".
        what: &'static str,
        /// The facets there.
        facets: FacetList,
        /// Number of such edges, or of fans at the vertex.
        count: usize,
    },
    /// Facets cannot be made to look to the same side, as on a Moebius strip.
    #[error(
        "the surface has only one side: {facets} cannot be made to agree with their neighbours"
    )]
    OneSided {
        /// The facets where the sides meet.
        facets: FacetList,
    },
    /// Facets have no area, or welding left them none.
    #[error(
        "{facets} {}, as vertices lie on a line within rounding or at the same place within the welding \
         distance: remove {}, or ask for repair",
        facets.one_or_more("has no area", "have no area"),
        facets.one_or_more("it", "them")
    )]
    DegenerateFacets {
        /// The facets.
        facets: FacetList,
    },
    /// Facets have the same vertices as earlier ones.
    #[error(
        "{facets} {}, or ask for repair",
        facets.one_or_more(
            "is a copy of an earlier one: remove it",
            "are copies of earlier ones: remove them"
        )
    )]
    DuplicateFacets {
        /// The copies.
        facets: FacetList,
    },
    /// The surface cuts or touches itself.
    #[error(
        "the surface cuts or touches itself: facets {} and {}{}: a body's surface must not",
        pairs[0][0], pairs[0][1],
        if pairs.len() > 1 { ", and others" } else { "" }
    )]
    SelfIntersecting {
        /// The first pairs of facets found, each once; at most eight.
        pairs: Vec<[usize; 2]>,
    },
    /// So many triangles overlap each other's boxes that searching for cuts would take too long.
    #[error(
        "the triangles of the {facets} facets are so long and thin and so many that cuts between \
         them cannot be looked for in reasonable time: split long facets"
    )]
    Tangled {
        /// Number of facets.
        facets: usize,
    },
    /// Too few points for a solid hull.
    #[error("{points} points: a convex hull needs at least 4 that span a volume")]
    TooFewPoints {
        /// Number of points given.
        points: usize,
    },
    /// Points from which no solid hull can be made: they coincide, or lie on a line or in a plane.
    #[error(
        "the {points} points {span} within {tolerance:e} m: a convex hull needs 4 points that span \
         a volume"
    )]
    FlatPoints {
        /// Number of points.
        points: usize,
        /// What the points do: "coincide", "lie on a line", "lie in a plane".
        span: &'static str,
        /// Tolerance used \[m\].
        tolerance: f64,
    },
    /// The hull of the points could not be cleaned into planar faces.
    #[error(
        "the convex hull of the {points} points has features too close to the resolution of \
         {tolerance:e} m to give clean faces: remove points that almost coincide"
    )]
    HullUnresolved {
        /// Number of points.
        points: usize,
        /// Resolution used \[m\].
        tolerance: f64,
    },
    /// A length, factor or other number lies outside its range.
    #[error("{what} is {value}: allowed is {allowed}")]
    OutOfRange {
        /// What the number is.
        what: &'static str,
        /// The value given.
        value: f64,
        /// The values allowed.
        allowed: &'static str,
    },
    /// No catalogue shape has that name.
    #[error(
        "no shape is called \"{name}\"; allowed are P1 to P5 (tetrahedron, icosahedron, \
         dodecahedron, octahedron, cube), A1 to A13 (truncated tetrahedron, truncated icosahedron, \
         snub cube, snub dodecahedron, rhombicosidodecahedron, truncated icosidodecahedron, \
         truncated cuboctahedron, icosidodecahedron, rhombicuboctahedron, truncated dodecahedron, \
         cuboctahedron, truncated cube, truncated octahedron), these names, and the mirror \
         images A3m and A4m"
    )]
    UnknownShape {
        /// The name asked for.
        name: String,
    },
    /// Neither a family of shapes nor a solid has that name.
    #[error(
        "no shape is called \"{name}\"; allowed are {families}, and the solids P1 to P5 and A1 to A13"
    )]
    UnknownFamily {
        /// The name asked for.
        name: String,
        /// The names of the families.
        families: String,
    },
    /// A shape has no parameter of that name.
    #[error("{shape} has no parameter \"{parameter}\"; allowed are: {allowed}")]
    UnknownParameter {
        /// The shape.
        shape: String,
        /// The name given.
        parameter: String,
        /// The names of its parameters.
        allowed: String,
    },
    /// A parameter of a shape has no valid value, or one outside its range.
    #[error("{parameter} of {shape} is \"{value}\": allowed is {allowed}")]
    BadParameter {
        /// The shape.
        shape: String,
        /// The parameter.
        parameter: &'static str,
        /// The value given.
        value: String,
        /// The values allowed.
        allowed: String,
    },
    /// A line of a text file cannot be understood.
    #[error("line {line}: {problem}")]
    Parse {
        /// Line number, from 1.
        line: usize,
        /// What is wrong and what is expected.
        problem: String,
    },
    /// A binary STL file is shorter or longer than its header says.
    #[error(
        "the binary STL header promises {promised} triangles ({expected} bytes), but there are \
         {found} bytes: the file is cut off, damaged, or goes on after its end"
    )]
    StlLength {
        /// Number of triangles in the header.
        promised: u32,
        /// Bytes a file of that many triangles has.
        expected: u64,
        /// Bytes found.
        found: u64,
    },
    /// A file ends before all the data that its header announces.
    #[error(
        "the file promises {promised} {what}, but ends after {found}: it is cut off or damaged"
    )]
    CutOff {
        /// What is counted.
        what: &'static str,
        /// The number announced by the file.
        promised: u64,
        /// The number found.
        found: u64,
    },
    /// Nodes of a file are numbered wrongly.
    #[error("the node with the tag {tag} {problem}")]
    NodeTag {
        /// The tag.
        tag: u64,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A file of an unsupported kind.
    #[error("the file has {what}, which is not read: {advice}")]
    Unsupported {
        /// What is not supported.
        what: String,
        /// What to do.
        advice: &'static str,
    },
    /// A file has no surface in it.
    #[error("the file holds no {what}")]
    Empty {
        /// What is missing.
        what: &'static str,
    },
    /// A file is larger than the readers accept.
    #[error("the file is larger than {allowed} bytes, the most that is read")]
    FileTooLarge {
        /// Largest size accepted \[bytes\].
        allowed: u64,
    },
    /// The extension of a file name is not that of a known format.
    #[error("cannot tell the format of {}: its name must end in .obj, .stl, .off or .ply", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A file holds a bad surface.
    #[error("{}: {problem}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: Box<MeshError>,
    },
    /// Reading or writing failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// A tetrahedral mesh without tetrahedra.
    #[error("the mesh has no tetrahedra: give at least one")]
    NoTetrahedra,
    /// A tetrahedron names a point that does not exist, or one twice.
    #[error(
        "tetrahedron {tet} names point {index} twice, or beyond the {count} points there are: \
         it needs four different indices below {count}"
    )]
    TetrahedronIndex {
        /// Index of the tetrahedron.
        tet: usize,
        /// The index it names.
        index: u32,
        /// Number of points.
        count: usize,
    },
    /// A point belongs to no tetrahedron.
    #[error("point {point} belongs to no tetrahedron: remove it")]
    UnusedPoint {
        /// Index of the point.
        point: usize,
    },
    /// A tetrahedron is flat or inverted.
    #[error(
        "tetrahedron {tet} has a volume of {volume:e} m^3: it must be positive (exchange two of \
         its points if it is inverted, remove it or move its points if it is flat)"
    )]
    FlatTetrahedron {
        /// Index of the tetrahedron.
        tet: usize,
        /// Its signed volume \[m^3\].
        volume: f64,
    },
    /// A triangle has more than two tetrahedra, or two on one side.
    #[error(
        "{count} tetrahedra share the triangle of points {points:?}, among them {first} and \
         {second}: there may be one on each of its sides"
    )]
    NonManifoldTriangle {
        /// Its points, sorted.
        points: [u32; 3],
        /// One of the tetrahedra.
        first: usize,
        /// Another one.
        second: usize,
        /// Number of tetrahedra that have it.
        count: usize,
    },
    /// The tetrahedra are not connected through triangles.
    #[error(
        "the tetrahedra form {pieces} pieces that share no triangle: a body must be one; \
         give each piece on its own, or mesh a body with thin parts more finely"
    )]
    SeveralPieces {
        /// Number of pieces.
        pieces: usize,
    },
    /// A convex body is required.
    #[error("the body is not convex: use star_fan or tet::mesh")]
    NotConvex,
    /// There is no point from which all of the surface can be seen.
    #[error(
        "the body is not star-shaped: no point lies behind the planes of faces {faces:?} (the best \
         is {radius:e} m behind all of them): use tet::mesh with an edge length"
    )]
    NotStarShaped {
        /// Faces that no point sees together.
        faces: Vec<usize>,
        /// Greatest depth of a point behind all planes \[m\], zero or negative.
        radius: f64,
    },
    /// A mesh has parts or holes that the body does not have, or lacks some.
    #[error(
        "the mesh has an Euler characteristic of {found}, the body of {expected}: parts of it are \
         thinner than the edge length"
    )]
    WrongTopology {
        /// Of the mesh's skin.
        found: i64,
        /// Of the body's surface.
        expected: i64,
    },
    /// The volume of a mesh is too far from the body's.
    #[error("the mesh's volume is off by {error:e} of the body's, allowed are {allowed:e}")]
    VolumeError {
        /// Mesh over body, less 1.
        error: f64,
        /// Largest magnitude allowed.
        allowed: f64,
    },
    /// A mesh has tetrahedra of bad shape.
    #[error("the mesh has a dihedral angle of {dihedral} rad, allowed are {allowed} rad and more")]
    BadShape {
        /// Smallest dihedral angle \[rad\].
        dihedral: f64,
        /// Smallest allowed \[rad\].
        allowed: f64,
    },
    /// A body is so thin for its size that a lattice fine enough for it would be too large.
    #[error(
        "the body is too thin for its size to be meshed: its mean thickness asks for a lattice with edges of \
         {length:.2e} m, of about {nodes:.1e} nodes, and at most 2e7 are allowed: make it thicker, take it \
         apart into several bodies, or give tetrahedra of your own"
    )]
    TooThin {
        /// Twice the volume over the area of the surface \[m\].
        length: f64,
        /// Nodes of a lattice with edges of this length.
        nodes: f64,
    },
    /// A number of a periodic cell is out of its range.
    #[error("{name} = {value} is not allowed: it must be {allowed}")]
    Cell {
        /// What the number is.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range in words.
        allowed: &'static str,
    },
    /// No mesh of a body could be made.
    #[error(
        "no mesh with edges from {asked:e} m down to {tried:e} m meets the options; at the last \
         length: {problem}; parts of the body may be thinner than that: ask for a shorter edge \
         length, allow more refinements, or relax the options"
    )]
    MeshingFailed {
        /// Edge length specified \[m\].
        asked: f64,
        /// Shortest length tried \[m\].
        tried: f64,
        /// What was wrong with the last mesh.
        problem: Box<MeshError>,
    },
}
