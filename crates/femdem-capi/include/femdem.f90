! femdem for Fortran 2018: the constants, types and functions of femdem.h, where they are described. Texts end with c_null_char. A
! number of C without sign is one with a sign here. Made of the header by tests/fortran.rs: do not edit.
module femdem
  use, intrinsic :: iso_c_binding
  implicit none
  public

  integer(c_int32_t), parameter :: FEMDEM_ABI_VERSION = 3
  integer(c_int32_t), parameter :: FEMDEM_MATTER_NEO_HOOKEAN = 0
  integer(c_int32_t), parameter :: FEMDEM_MATTER_HENCKY = 1
  integer(c_int32_t), parameter :: FEMDEM_MATTER_MOONEY_RIVLIN = 2
  integer(c_int32_t), parameter :: FEMDEM_MATTER_J2 = 3
  integer(c_int32_t), parameter :: FEMDEM_MATTER_DRUCKER_PRAGER = 4
  integer(c_int32_t), parameter :: FEMDEM_ELEMENT_T4 = 0
  integer(c_int32_t), parameter :: FEMDEM_ELEMENT_T4_NODAL_PRESSURE = 1
  integer(c_int32_t), parameter :: FEMDEM_ELEMENT_T10 = 2
  integer(c_int32_t), parameter :: FEMDEM_ELEMENT_T10_FBAR = 3
  integer(c_int32_t), parameter :: FEMDEM_SOFTENING_LINEAR = 0
  integer(c_int32_t), parameter :: FEMDEM_SOFTENING_EXPONENTIAL = 1
  integer(c_int32_t), parameter :: FEMDEM_SOFTENING_BILINEAR = 2
  integer(c_int32_t), parameter :: FEMDEM_AXIS_X = 1
  integer(c_int32_t), parameter :: FEMDEM_AXIS_Y = 2
  integer(c_int32_t), parameter :: FEMDEM_AXIS_Z = 4
  integer(c_int32_t), parameter :: FEMDEM_DRIVE_FIXED = 0
  integer(c_int32_t), parameter :: FEMDEM_DRIVE_LINEAR = 1
  integer(c_int32_t), parameter :: FEMDEM_DRIVE_SHAKE = 2
  integer(c_int32_t), parameter :: FEMDEM_DRIVE_TURN = 3
  integer(c_int), parameter :: FEMDEM_STATUS_OK = 0
  integer(c_int), parameter :: FEMDEM_STATUS_NULL = 1
  integer(c_int), parameter :: FEMDEM_STATUS_HANDLE = 2
  integer(c_int), parameter :: FEMDEM_STATUS_SIZE = 3
  integer(c_int), parameter :: FEMDEM_STATUS_REFUSED = 4
  integer(c_int), parameter :: FEMDEM_STATUS_FILE = 5
  integer(c_int), parameter :: FEMDEM_STATUS_FAILED = 6
  integer(c_int), parameter :: FEMDEM_STATUS_BUSY = 7
  integer(c_int), parameter :: FEMDEM_STATUS_FAULT = 8

  type, bind(c) :: femdem_law_t
    real(c_double) :: penalty = 0d0
    real(c_double) :: friction = 0d0
    real(c_double) :: wall_friction = 0d0
    real(c_double) :: rolling_friction = 0d0
    real(c_double) :: damping_ratio = 0d0
    real(c_double) :: tangential_ratio = 0d0
    real(c_double) :: tangential_damping = 0d0
    real(c_double) :: cohesion = 0d0
    real(c_double) :: adhesion_energy = 0d0
    real(c_double) :: bridge_volume = 0d0
    real(c_double) :: bridge_tension = 0d0
    real(c_double) :: bridge_angle = 0d0
  end type

  type, bind(c) :: femdem_batch_t
    integer(c_int64_t) :: id = 0
  end type

  type, bind(c) :: femdem_shape_t
    integer(c_int64_t) :: id = 0
  end type

  type, bind(c) :: femdem_plane_t
    real(c_double) :: normal(3) = 0d0
    real(c_double) :: offset = 0d0
  end type

  type, bind(c) :: femdem_box_t
    real(c_double) :: low(3) = 0d0
    real(c_double) :: high(3) = 0d0
  end type

  type, bind(c) :: femdem_sides_t
    integer(c_int32_t) :: low(3) = 0
    integer(c_int32_t) :: high(3) = 0
  end type

  type, bind(c) :: femdem_batch_totals_t
    real(c_double) :: energy = 0d0
    real(c_double) :: spring_energy = 0d0
    real(c_double) :: stable_step = 0d0
    integer(c_size_t) :: candidates = 0
    integer(c_size_t) :: touching = 0
  end type

  type, bind(c) :: femdem_load_t
    real(c_double) :: force(3) = 0d0
    real(c_double) :: torque(3) = 0d0
  end type

  type, bind(c) :: femdem_contact_t
    integer(c_int32_t) :: a = 0
    integer(c_int32_t) :: b = 0
    integer(c_int32_t) :: a_is_wall = 0
    integer(c_int32_t) :: patch = 0
    integer(c_int32_t) :: slides = 0
    real(c_double) :: point(3) = 0d0
    real(c_double) :: normal(3) = 0d0
    real(c_double) :: force(3) = 0d0
    real(c_double) :: friction(3) = 0d0
    real(c_double) :: normal_force = 0d0
    real(c_double) :: area = 0d0
    real(c_double) :: volume = 0d0
    real(c_double) :: energy = 0d0
    real(c_double) :: stiffness = 0d0
  end type

  type, bind(c) :: femdem_pose_t
    real(c_double) :: position(3) = 0d0
    real(c_double) :: rotation(4) = [1d0, 0d0, 0d0, 0d0]
  end type

  type, bind(c) :: femdem_velocity_t
    real(c_double) :: linear(3) = 0d0
    real(c_double) :: angular(3) = 0d0
  end type

  type, bind(c) :: femdem_motion_t
    type(femdem_pose_t) :: pose
    type(femdem_velocity_t) :: velocity
  end type

  type, bind(c) :: femdem_world_t
    integer(c_int64_t) :: id = 0
  end type

  type, bind(c) :: femdem_matter_t
    real(c_double) :: density = 0d0
    real(c_double) :: young = 0d0
    real(c_double) :: poisson = 0d0
    real(c_double) :: shear_viscosity = 0d0
    real(c_double) :: bulk_viscosity = 0d0
    real(c_double) :: contact_ratio = 0d0
    real(c_double) :: share = 0d0
    real(c_double) :: yield_stress = 0d0
    real(c_double) :: hardening = 0d0
    real(c_double) :: saturation_stress = 0d0
    real(c_double) :: saturation_rate = 0d0
    real(c_double) :: cohesion = 0d0
    real(c_double) :: friction_angle = 0d0
    real(c_double) :: dilatancy_angle = 0d0
    integer(c_int32_t) :: law = 0
    integer(c_int32_t) :: element = 0
  end type

  type, bind(c) :: femdem_fracture_t
    real(c_double) :: tensile = 0d0
    real(c_double) :: cohesion = 0d0
    real(c_double) :: friction_angle = 0d0
    real(c_double) :: opening_energy = 0d0
    real(c_double) :: sliding_energy = 0d0
    real(c_double) :: mix = 0d0
    real(c_double) :: stiffness = 0d0
    real(c_double) :: weibull_modulus = 0d0
    real(c_double) :: weibull_volume = 0d0
    integer(c_int64_t) :: weibull_seed = 0
    integer(c_int32_t) :: every = 0
    integer(c_int32_t) :: softening = 0
    integer(c_int32_t) :: coarse = 0
    integer(c_int32_t) :: pieces = 0
  end type

  type, bind(c) :: femdem_pair_t
    type(femdem_load_t) :: on_a
    type(femdem_load_t) :: on_b
    real(c_double) :: energy = 0d0
    real(c_double) :: volume = 0d0
    real(c_double) :: area = 0d0
    real(c_double) :: stiffness = 0d0
    integer(c_int32_t) :: patches = 0
  end type

  type, bind(c) :: femdem_shape_properties_t
    real(c_double) :: volume = 0d0
    real(c_double) :: area = 0d0
    real(c_double) :: radius = 0d0
    real(c_double) :: centroid(3) = 0d0
    real(c_double) :: inertia(9) = 0d0
    integer(c_int32_t) :: kind = 0
    integer(c_int32_t) :: vertex_count = 0
    integer(c_int32_t) :: triangle_count = 0
  end type

  type, bind(c) :: femdem_bond_law_t
    real(c_double) :: stiffness = 0d0
    real(c_double) :: tensile = 0d0
    real(c_double) :: cohesion = 0d0
    real(c_double) :: friction = 0d0
    real(c_double) :: opening_energy = 0d0
    real(c_double) :: sliding_energy = 0d0
    real(c_double) :: mix = 0d0
    real(c_double) :: damping = 0d0
    integer(c_int32_t) :: softening = 0
  end type

  type, bind(c) :: femdem_bond_t
    integer(c_int32_t) :: bond = 0
    integer(c_int32_t) :: a = 0
    integer(c_int32_t) :: b = 0
    integer(c_int32_t) :: broken = 0
    integer(c_int32_t) :: ended = 0
    real(c_double) :: area = 0d0
    real(c_double) :: centre(3) = 0d0
    real(c_double) :: normal(3) = 0d0
    real(c_double) :: force(3) = 0d0
    real(c_double) :: moment(3) = 0d0
    real(c_double) :: tension = 0d0
    real(c_double) :: energy = 0d0
    real(c_double) :: dissipated = 0d0
    real(c_double) :: damage = 0d0
    real(c_double) :: mode = 0d0
    real(c_double) :: broken_at = 0d0
  end type

  type, bind(c) :: femdem_matrix_t
    real(c_double) :: rows(9) = 0d0
  end type

  type, bind(c) :: femdem_crack_t
    integer(c_int64_t) :: tets(2) = 0
    real(c_double) :: corners(9) = 0d0
    real(c_double) :: opening = 0d0
    real(c_double) :: slip = 0d0
    real(c_double) :: damage = 0d0
    real(c_double) :: birth = 0d0
    real(c_double) :: broken_at = 0d0
    real(c_double) :: dissipated = 0d0
    integer(c_int32_t) :: sheared = 0
  end type

  type, bind(c) :: femdem_fragment_t
    integer(c_int32_t) :: body = 0
    integer(c_int32_t) :: of = 0
  end type

  type, bind(c) :: femdem_drive_t
    integer(c_int32_t) :: kind = 0
    integer(c_int32_t) :: periods = 0
    real(c_double) :: vector(3) = 0d0
    real(c_double) :: point(3) = 0d0
    real(c_double) :: rate = 0d0
    real(c_double) :: frequency = 0d0
    real(c_double) :: start = 0d0
    real(c_double) :: end = 0d0
  end type

  type, bind(c) :: femdem_deformable_t
    real(c_double) :: mass = 0d0
    real(c_double) :: centroid(3) = 0d0
    real(c_double) :: velocity(3) = 0d0
    real(c_double) :: kinetic_energy = 0d0
    real(c_double) :: strain_energy = 0d0
    integer(c_size_t) :: node_count = 0
    integer(c_size_t) :: tet_count = 0
    integer(c_size_t) :: triangle_count = 0
    integer(c_int32_t) :: model = 0
    integer(c_int32_t) :: breakable = 0
    integer(c_int32_t) :: asleep = 0
  end type

  type, bind(c) :: femdem_world_parameters_t
    real(c_double) :: gravity(3) = 0d0
    type(femdem_law_t) :: law
    real(c_double) :: safety = 0d0
    real(c_double) :: largest_step = 0d0
    real(c_double) :: drag = 0d0
    real(c_double) :: local_damping = 0d0
    real(c_double) :: sleep_tolerance = 0d0
    integer(c_int32_t) :: sleep_window = 0
    integer(c_int32_t) :: sleeping = 0
    integer(c_int32_t) :: implicit = 0
  end type

  type, bind(c) :: femdem_world_state_t
    real(c_double) :: time = 0d0
    real(c_double) :: time_step = 0d0
    real(c_double) :: stable_step = 0d0
    real(c_double) :: residual = 0d0
    integer(c_int64_t) :: steps = 0
    integer(c_size_t) :: body_count = 0
    integer(c_size_t) :: deformable_count = 0
    integer(c_size_t) :: awake_count = 0
    integer(c_size_t) :: wall_count = 0
  end type

  type, bind(c) :: femdem_ledger_t
    real(c_double) :: initial = 0d0
    real(c_double) :: by_hand = 0d0
    real(c_double) :: work_in = 0d0
    real(c_double) :: load_work = 0d0
    real(c_double) :: lent = 0d0
    real(c_double) :: kinetic = 0d0
    real(c_double) :: potential = 0d0
    real(c_double) :: elastic = 0d0
    real(c_double) :: strain = 0d0
    real(c_double) :: friction_springs = 0d0
    real(c_double) :: cracks = 0d0
    real(c_double) :: bonds = 0d0
    real(c_double) :: dissipated_friction = 0d0
    real(c_double) :: dissipated_damping = 0d0
    real(c_double) :: dissipated_medium = 0d0
    real(c_double) :: dissipated_viscous = 0d0
    real(c_double) :: dissipated_plastic = 0d0
    real(c_double) :: dissipated_bridges = 0d0
    real(c_double) :: dissipated_fracture = 0d0
    real(c_double) :: dissipated_bonds = 0d0
    real(c_double) :: dissipated_release = 0d0
    real(c_double) :: dissipated_step = 0d0
    real(c_double) :: frozen = 0d0
    real(c_double) :: exchanged = 0d0
    real(c_double) :: dissipated = 0d0
    real(c_double) :: error = 0d0
    real(c_double) :: error_relative = 0d0
  end type

  interface
    function femdem_abi() &
        bind(c) result(answer)
      import
      integer(c_int32_t) :: answer
    end function

    function femdem_version() &
        bind(c) result(answer)
      import
      type(c_ptr) :: answer
    end function

    function femdem_batch_new(law, batch) &
        bind(c) result(answer)
      import
      type(femdem_law_t), intent(in) :: law
      type(femdem_batch_t), intent(out) :: batch
      integer(c_int) :: answer
    end function

    function femdem_batch_set_threads(batch, threads) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int32_t), value :: threads
      integer(c_int) :: answer
    end function

    function femdem_batch_set_law(batch, material_a, material_b, law) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int32_t), value :: material_a
      integer(c_int32_t), value :: material_b
      type(femdem_law_t), intent(in), optional :: law
      integer(c_int) :: answer
    end function

    function femdem_batch_add_body(batch, shape, density, material_id, body) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      type(femdem_shape_t), value :: shape
      real(c_double), value :: density
      integer(c_int32_t), value :: material_id
      integer(c_int32_t), intent(out) :: body
      integer(c_int) :: answer
    end function

    function femdem_batch_set_mass(batch, body, mass, inertia, count) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int32_t), value :: body
      real(c_double), value :: mass
      real(c_double), intent(in) :: inertia(*)
      integer(c_size_t), value :: count
      integer(c_int) :: answer
    end function

    function femdem_batch_remove_body(batch, body) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int32_t), value :: body
      integer(c_int) :: answer
    end function

    function femdem_batch_forget_contacts(batch, body) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int32_t), value :: body
      integer(c_int) :: answer
    end function

    function femdem_batch_add_plane(batch, plane, material_id, wall) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      type(femdem_plane_t), intent(in) :: plane
      integer(c_int32_t), value :: material_id
      integer(c_int32_t), intent(out) :: wall
      integer(c_int) :: answer
    end function

    function femdem_batch_add_box(batch, inside, material_id, sides) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      type(femdem_box_t), intent(in) :: inside
      integer(c_int32_t), value :: material_id
      type(femdem_sides_t), intent(out), optional :: sides
      integer(c_int) :: answer
    end function

    function femdem_batch_add_sheet(batch, vertices, vertex_count, triangles, triangle_count, thickness, material_id, wall) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      real(c_double), intent(in) :: vertices(*)
      integer(c_size_t), value :: vertex_count
      integer(c_int32_t), intent(in) :: triangles(*)
      integer(c_size_t), value :: triangle_count
      real(c_double), value :: thickness
      integer(c_int32_t), value :: material_id
      integer(c_int32_t), intent(out) :: wall
      integer(c_int) :: answer
    end function

    function femdem_batch_remove_wall(batch, wall) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int32_t), value :: wall
      integer(c_int) :: answer
    end function

    function femdem_batch_totals(batch, totals) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      type(femdem_batch_totals_t), intent(out) :: totals
      integer(c_int) :: answer
    end function

    function femdem_batch_wall_loads(batch, loads, count) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      type(femdem_load_t), intent(inout) :: loads(*)
      integer(c_size_t), value :: count
      integer(c_int) :: answer
    end function

    function femdem_batch_contacts(batch, contacts, room, count) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      type(femdem_contact_t), intent(inout) :: contacts(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_batch_slots(batch, bodies, walls) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_size_t), intent(out), optional :: bodies
      integer(c_size_t), intent(out), optional :: walls
      integer(c_int) :: answer
    end function

    function femdem_batch_update(batch, motions, motion_count, dt, loads, load_count) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      type(femdem_motion_t), intent(in) :: motions(*)
      integer(c_size_t), value :: motion_count
      real(c_double), value :: dt
      type(femdem_load_t), intent(inout) :: loads(*)
      integer(c_size_t), value :: load_count
      integer(c_int) :: answer
    end function

    function femdem_batch_move_wall(batch, wall, motion) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int32_t), value :: wall
      type(femdem_motion_t), intent(in) :: motion
      integer(c_int) :: answer
    end function

    function femdem_last_error() &
        bind(c) result(answer)
      import
      type(c_ptr) :: answer
    end function

    function femdem_shape_free(shape) &
        bind(c) result(answer)
      import
      type(femdem_shape_t), value :: shape
      integer(c_int) :: answer
    end function

    function femdem_batch_free(batch) &
        bind(c) result(answer)
      import
      type(femdem_batch_t), value :: batch
      integer(c_int) :: answer
    end function

    function femdem_world_free(world) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int) :: answer
    end function

    function femdem_law_default(law) &
        bind(c) result(answer)
      import
      type(femdem_law_t), intent(out) :: law
      integer(c_int) :: answer
    end function

    function femdem_matter_default(matter) &
        bind(c) result(answer)
      import
      type(femdem_matter_t), intent(out) :: matter
      integer(c_int) :: answer
    end function

    function femdem_fracture_default(fracture) &
        bind(c) result(answer)
      import
      type(femdem_fracture_t), intent(out) :: fracture
      integer(c_int) :: answer
    end function

    function femdem_pair_evaluate(penalty, a, pose_a, b, pose_b, pair) &
        bind(c) result(answer)
      import
      real(c_double), value :: penalty
      type(femdem_shape_t), value :: a
      type(femdem_pose_t), intent(in) :: pose_a
      type(femdem_shape_t), value :: b
      type(femdem_pose_t), intent(in) :: pose_b
      type(femdem_pair_t), intent(out) :: pair
      integer(c_int) :: answer
    end function

    function femdem_shape_named(name, size, mesh_size, shape) &
        bind(c) result(answer)
      import
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: size
      real(c_double), value :: mesh_size
      type(femdem_shape_t), intent(out) :: shape
      integer(c_int) :: answer
    end function

    function femdem_shape_surface(vertices, vertex_count, triangles, triangle_count, mesh_size, shape) &
        bind(c) result(answer)
      import
      real(c_double), intent(in) :: vertices(*)
      integer(c_size_t), value :: vertex_count
      integer(c_int32_t), intent(in) :: triangles(*)
      integer(c_size_t), value :: triangle_count
      real(c_double), value :: mesh_size
      type(femdem_shape_t), intent(out) :: shape
      integer(c_int) :: answer
    end function

    function femdem_shape_hull(vertices, count, shape) &
        bind(c) result(answer)
      import
      real(c_double), intent(in) :: vertices(*)
      integer(c_size_t), value :: count
      type(femdem_shape_t), intent(out) :: shape
      integer(c_int) :: answer
    end function

    function femdem_shape_file(path, unit, mesh_size, shape) &
        bind(c) result(answer)
      import
      character(kind=c_char), intent(in) :: path(*)
      real(c_double), value :: unit
      real(c_double), value :: mesh_size
      type(femdem_shape_t), intent(out) :: shape
      integer(c_int) :: answer
    end function

    function femdem_shape_properties(shape, properties) &
        bind(c) result(answer)
      import
      type(femdem_shape_t), value :: shape
      type(femdem_shape_properties_t), intent(out) :: properties
      integer(c_int) :: answer
    end function

    function femdem_shape_triangles(shape, vertices, vertex_count, triangles, triangle_count) &
        bind(c) result(answer)
      import
      type(femdem_shape_t), value :: shape
      real(c_double), intent(inout) :: vertices(*)
      integer(c_size_t), value :: vertex_count
      integer(c_int32_t), intent(inout) :: triangles(*)
      integer(c_size_t), value :: triangle_count
      integer(c_int) :: answer
    end function

    function femdem_bond_law_default(law) &
        bind(c) result(answer)
      import
      type(femdem_bond_law_t), intent(out) :: law
      integer(c_int) :: answer
    end function

    function femdem_world_add_bond(world, body_a, body_b, corners, corner_count, law, bond) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body_a
      integer(c_int32_t), value :: body_b
      real(c_double), intent(in) :: corners(*)
      integer(c_size_t), value :: corner_count
      type(femdem_bond_law_t), intent(in) :: law
      integer(c_int32_t), intent(out) :: bond
      integer(c_int) :: answer
    end function

    function femdem_world_add_bond_between(world, body_a, body_b, gap, ratio, law, bond) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body_a
      integer(c_int32_t), value :: body_b
      real(c_double), value :: gap
      real(c_double), value :: ratio
      type(femdem_bond_law_t), intent(in) :: law
      integer(c_int32_t), intent(out) :: bond
      integer(c_int) :: answer
    end function

    function femdem_world_bonds(world, bonds, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_bond_t), intent(inout) :: bonds(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_add_body(world, shape, density, motion, material_id, body) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_shape_t), value :: shape
      real(c_double), value :: density
      type(femdem_motion_t), intent(in) :: motion
      integer(c_int32_t), value :: material_id
      integer(c_int32_t), intent(out) :: body
      integer(c_int) :: answer
    end function

    function femdem_world_add_plane(world, plane, material_id, wall) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_plane_t), intent(in) :: plane
      integer(c_int32_t), value :: material_id
      integer(c_int32_t), intent(out) :: wall
      integer(c_int) :: answer
    end function

    function femdem_world_add_box(world, inside, material_id, sides) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_box_t), intent(in) :: inside
      integer(c_int32_t), value :: material_id
      type(femdem_sides_t), intent(out), optional :: sides
      integer(c_int) :: answer
    end function

    function femdem_world_add_sheet(world, vertices, vertex_count, triangles, triangle_count, thickness, material_id, wall) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      real(c_double), intent(in) :: vertices(*)
      integer(c_size_t), value :: vertex_count
      integer(c_int32_t), intent(in) :: triangles(*)
      integer(c_size_t), value :: triangle_count
      real(c_double), value :: thickness
      integer(c_int32_t), value :: material_id
      integer(c_int32_t), intent(out) :: wall
      integer(c_int) :: answer
    end function

    function femdem_world_set_cell(world, x, y, z) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      real(c_double), value :: x
      real(c_double), value :: y
      real(c_double), value :: z
      integer(c_int) :: answer
    end function

    function femdem_world_deform_cell(world, rates) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_matrix_t), intent(in) :: rates
      integer(c_int) :: answer
    end function

    function femdem_world_cell(world, edges) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_matrix_t), intent(out) :: edges
      integer(c_int) :: answer
    end function

    function femdem_world_cell_stress(world, stress) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_matrix_t), intent(out) :: stress
      integer(c_int) :: answer
    end function

    function femdem_world_cracks(world, body, cracks, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_crack_t), intent(inout) :: cracks(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_fragments(world, body, fragments, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      integer(c_int32_t), intent(inout) :: fragments(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_fragment_bodies(world, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_new_fragments(world, fragments, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_fragment_t), intent(inout) :: fragments(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_add_model(world, points, point_count, tets, tet_count, matter, model) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: point_count
      integer(c_int32_t), intent(in) :: tets(*)
      integer(c_size_t), value :: tet_count
      type(femdem_matter_t), intent(in) :: matter
      integer(c_int32_t), intent(out) :: model
      integer(c_int) :: answer
    end function

    function femdem_world_add_model_of_shape(world, shape, mesh_size, matter, model) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_shape_t), value :: shape
      real(c_double), value :: mesh_size
      type(femdem_matter_t), intent(in) :: matter
      integer(c_int32_t), intent(out) :: model
      integer(c_int) :: answer
    end function

    function femdem_world_add_deformable(world, model, motion, fracture, material_id, body) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: model
      type(femdem_motion_t), intent(in) :: motion
      type(femdem_fracture_t), intent(in), optional :: fracture
      integer(c_int32_t), value :: material_id
      integer(c_int32_t), intent(out) :: body
      integer(c_int) :: answer
    end function

    function femdem_world_drive_nodes(world, body, nodes, node_count, axes, drive) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      integer(c_int32_t), intent(in) :: nodes(*)
      integer(c_size_t), value :: node_count
      integer(c_int32_t), value :: axes
      type(femdem_drive_t), intent(in) :: drive
      integer(c_int) :: answer
    end function

    function femdem_world_release(world, body) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      integer(c_int) :: answer
    end function

    function femdem_world_drive_wall(world, wall, drive) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: wall
      type(femdem_drive_t), intent(in) :: drive
      integer(c_int) :: answer
    end function

    function femdem_world_drive_body(world, body, drive) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_drive_t), intent(in), optional :: drive
      integer(c_int) :: answer
    end function

    function femdem_world_save(world, path) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: answer
    end function

    function femdem_world_load(path, world) &
        bind(c) result(answer)
      import
      character(kind=c_char), intent(in) :: path(*)
      type(femdem_world_t), intent(out) :: world
      integer(c_int) :: answer
    end function

    function femdem_world_to_bytes(world, bytes, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int8_t), intent(inout) :: bytes(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_from_bytes(bytes, count, world) &
        bind(c) result(answer)
      import
      integer(c_int8_t), intent(in) :: bytes(*)
      integer(c_size_t), value :: count
      type(femdem_world_t), intent(out) :: world
      integer(c_int) :: answer
    end function

    function femdem_world_set_pose(world, body, pose) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_pose_t), intent(in) :: pose
      integer(c_int) :: answer
    end function

    function femdem_world_set_velocity(world, body, velocity) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_velocity_t), intent(in) :: velocity
      integer(c_int) :: answer
    end function

    function femdem_world_set_load(world, body, load) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_load_t), intent(in) :: load
      integer(c_int) :: answer
    end function

    function femdem_world_remove_body(world, body) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      integer(c_int) :: answer
    end function

    function femdem_world_remove_wall(world, wall) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: wall
      integer(c_int) :: answer
    end function

    function femdem_world_deformables(world, bodies, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), intent(inout) :: bodies(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_deformable(world, body, deformable) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_deformable_t), intent(out) :: deformable
      integer(c_int) :: answer
    end function

    function femdem_world_node_positions(world, body, positions, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      real(c_double), intent(inout) :: positions(*)
      integer(c_size_t), value :: count
      integer(c_int) :: answer
    end function

    function femdem_world_node_velocities(world, body, velocities, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      real(c_double), intent(inout) :: velocities(*)
      integer(c_size_t), value :: count
      integer(c_int) :: answer
    end function

    function femdem_world_tets(world, body, tets, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      integer(c_int32_t), intent(inout) :: tets(*)
      integer(c_size_t), value :: count
      integer(c_int) :: answer
    end function

    function femdem_world_skin(world, body, triangles, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      integer(c_int32_t), intent(inout) :: triangles(*)
      integer(c_size_t), value :: count
      integer(c_int) :: answer
    end function

    function femdem_world_stresses(world, body, stresses, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      real(c_double), intent(inout) :: stresses(*)
      integer(c_size_t), value :: count
      integer(c_int) :: answer
    end function

    function femdem_world_defaults(parameters) &
        bind(c) result(answer)
      import
      type(femdem_world_parameters_t), intent(out) :: parameters
      integer(c_int) :: answer
    end function

    function femdem_world_new(parameters, world) &
        bind(c) result(answer)
      import
      type(femdem_world_parameters_t), intent(in) :: parameters
      type(femdem_world_t), intent(out) :: world
      integer(c_int) :: answer
    end function

    function femdem_world_set_threads(world, threads) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: threads
      integer(c_int) :: answer
    end function

    function femdem_world_set_law(world, material_a, material_b, law) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: material_a
      integer(c_int32_t), value :: material_b
      type(femdem_law_t), intent(in), optional :: law
      integer(c_int) :: answer
    end function

    function femdem_world_set_gravity(world, x, y, z) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      real(c_double), value :: x
      real(c_double), value :: y
      real(c_double), value :: z
      integer(c_int) :: answer
    end function

    function femdem_world_state(world, state) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_world_state_t), intent(out) :: state
      integer(c_int) :: answer
    end function

    function femdem_world_hash(world, hash) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int64_t), intent(out) :: hash
      integer(c_int) :: answer
    end function

    function femdem_world_ledger(world, ledger) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_ledger_t), intent(out) :: ledger
      integer(c_int) :: answer
    end function

    function femdem_world_bodies(world, bodies, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), intent(inout) :: bodies(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_motions(world, motions, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_motion_t), intent(inout) :: motions(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_motion(world, body, motion) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_motion_t), intent(out) :: motion
      integer(c_int) :: answer
    end function

    function femdem_world_body_load(world, body, load) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: body
      type(femdem_load_t), intent(out) :: load
      integer(c_int) :: answer
    end function

    function femdem_world_wall_load(world, wall, load) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int32_t), value :: wall
      type(femdem_load_t), intent(out) :: load
      integer(c_int) :: answer
    end function

    function femdem_world_contacts(world, contacts, room, count) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      type(femdem_contact_t), intent(inout) :: contacts(*)
      integer(c_size_t), value :: room
      integer(c_size_t), intent(out) :: count
      integer(c_int) :: answer
    end function

    function femdem_world_step(world, steps) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      integer(c_int64_t), value :: steps
      integer(c_int) :: answer
    end function

    function femdem_world_step_until(world, time) &
        bind(c) result(answer)
      import
      type(femdem_world_t), value :: world
      real(c_double), value :: time
      integer(c_int) :: answer
    end function

    pure function femdem_length(text) bind(c, name="strlen") result(length)
      import
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function
  end interface

contains

  ! The message of the last call of this thread that failed.
  function femdem_message() result(message)
    character(:), allocatable :: message
    character(kind=c_char), pointer :: bytes(:)
    type(c_ptr) :: text
    integer :: k
    text = femdem_last_error()
    call c_f_pointer(text, bytes, [femdem_length(text)])
    allocate(character(size(bytes)) :: message)
    do k = 1, size(bytes)
      message(k:k) = bytes(k)
    end do
  end function
end module
