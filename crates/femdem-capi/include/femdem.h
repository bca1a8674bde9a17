/*
 * femdem: contacts and motion of bodies of any shape. SI units; vectors in world axes unless said otherwise.
 *
 * Begin with shapes. femdem_pair_evaluate is for codes with their own search and friction, a batch for codes with their own
 * integrator, a world for the rest.
 *
 * Every function but femdem_abi, femdem_version and femdem_last_error returns a FemdemStatus; the last has the message. What fails
 * has changed nothing, but for steps: those taken before one that fails stay. A handle that is 0, freed or of another kind, null
 * where a value is needed, and wrong lengths are statuses. Else a pointer must lead to as many values as said, which nothing writes
 * during the call; outputs are aligned and do not overlap each other or inputs. Texts are in UTF-8 and end with a zero.
 *
 * Any thread may use any handle, one thread at a time: another gets FEMDEM_STATUS_BUSY at once. Shapes are for all at a time.
 * A batch or world keeps the memory of each shape that it has used, until it is freed.
 * Batches and worlds compute on the threads of the process, one per core or as many as RAYON_NUM_THREADS says, or on their own
 * after femdem_batch_set_threads and femdem_world_set_threads. Results are the same bits for any number.
 *
 * Made from the Rust sources by cbindgen: do not edit.
 */


#ifndef FEMDEM_H
#define FEMDEM_H

#include <stddef.h>
#include <stdint.h>

/*
 Number of the interface: it rises with every change after which a program has to be compiled anew.
 */
#define FEMDEM_ABI_VERSION 3

/*
 Law of a FemdemMatter: compressible neo-Hookean.
 */
#define FEMDEM_MATTER_NEO_HOOKEAN 0

/*
 Law of a FemdemMatter: linear in the logarithmic strain.
 */
#define FEMDEM_MATTER_HENCKY 1

/*
 Law of a FemdemMatter: Mooney-Rivlin, with `share`.
 */
#define FEMDEM_MATTER_MOONEY_RIVLIN 2

/*
 Law of a FemdemMatter: von Mises plasticity, with `yield_stress` and hardening.
 */
#define FEMDEM_MATTER_J2 3

/*
 Law of a FemdemMatter: Drucker-Prager plasticity, with `cohesion` and angles.
 */
#define FEMDEM_MATTER_DRUCKER_PRAGER 4

/*
 Elements of a FemdemMatter: linear tetrahedra.
 */
#define FEMDEM_ELEMENT_T4 0

/*
 Elements of a FemdemMatter: linear tetrahedra with pressures averaged at the nodes, for matter that hardly changes its volume.
 */
#define FEMDEM_ELEMENT_T4_NODAL_PRESSURE 1

/*
 Elements of a FemdemMatter: quadratic tetrahedra.
 */
#define FEMDEM_ELEMENT_T10 2

/*
 Elements of a FemdemMatter: quadratic tetrahedra with F-bar, for matter that hardly changes its volume.
 */
#define FEMDEM_ELEMENT_T10_FBAR 3

/*
 Softening of a FemdemBondLaw or FemdemFracture: along a straight line.
 */
#define FEMDEM_SOFTENING_LINEAR 0

/*
 Softening of a FemdemBondLaw or FemdemFracture: along an exponential that ends.
 */
#define FEMDEM_SOFTENING_EXPONENTIAL 1

/*
 Softening of a FemdemBondLaw or FemdemFracture: along two straight lines, as of concrete.
 */
#define FEMDEM_SOFTENING_BILINEAR 2

/*
 Axes of femdem_world_drive_nodes: x.
 */
#define FEMDEM_AXIS_X 1

/*
 Axes of femdem_world_drive_nodes: y.
 */
#define FEMDEM_AXIS_Y 2

/*
 Axes of femdem_world_drive_nodes: z.
 */
#define FEMDEM_AXIS_Z 4

/*
 Kind of a FemdemDrive: held where it is.
 */
#define FEMDEM_DRIVE_FIXED 0

/*
 Kind of a FemdemDrive: at the velocity `vector` in m/s from `start` to `end`.
 */
#define FEMDEM_DRIVE_LINEAR 1

/*
 Kind of a FemdemDrive: from `start` on, `periods` of a swing (1 - cos(2 pi `frequency` t))/2 along the stroke `vector` in m.
 */
#define FEMDEM_DRIVE_SHAKE 2

/*
 Kind of a FemdemDrive: about an axis `vector` through `point` at `rate` in rad/s from `start` to `end`.
 */
#define FEMDEM_DRIVE_TURN 3

/*
 What a function returns. Anything but FEMDEM_STATUS_OK has a message: femdem_last_error.
 */
typedef enum {
  /*
   Done.
   */
  FEMDEM_STATUS_OK = 0,
  /*
   A pointer is null, or a handle is 0.
   */
  FEMDEM_STATUS_NULL = 1,
  /*
   A handle that was freed, is of another kind, or was never given out.
   */
  FEMDEM_STATUS_HANDLE = 2,
  /*
   An array has the wrong length; the message has the right one. A function with a `count` to write has written it there.
   */
  FEMDEM_STATUS_SIZE = 3,
  /*
   A value is out of range, or a number names nothing. Nothing was changed.
   */
  FEMDEM_STATUS_REFUSED = 4,
  /*
   A file could not be read or written, or holds something else.
   */
  FEMDEM_STATUS_FILE = 5,
  /*
   The simulation has left physical bounds; the world or batch is of no further use.
   */
  FEMDEM_STATUS_FAILED = 6,
  /*
   Another thread is in a call with this handle.
   */
  FEMDEM_STATUS_BUSY = 7,
  /*
   A fault of femdem itself; please report it. A batch or world of the call is of no further use, and can only be freed.
   */
  FEMDEM_STATUS_FAULT = 8,
} FemdemStatus;

/*
 How bodies meet each other and walls. Begin with femdem_law_default.
 */
typedef struct {
  /*
   Penalty p, from 1e-100 to 1e100 Pa: the contact energy is p times the integral of both fields over the overlap.
   */
  double penalty;
  /*
   Coulomb's coefficient of friction, at least 0.
   */
  double friction;
  /*
   The same between bodies and walls; NaN, the default, stands for that between bodies.
   */
  double wall_friction;
  /*
   Coefficient of rolling friction, at least 0.
   */
  double rolling_friction;
  /*
   Part of the critical damping of the normal contact, from 0 to below 0.7071.
   */
  double damping_ratio;
  /*
   Tangential over normal stiffness, above 0, at most 2.
   */
  double tangential_ratio;
  /*
   Part of the critical damping of the friction springs, from 0 to 1.
   */
  double tangential_damping;
  /*
   Cohesion, Pa: an attraction by this stress over the contact area.
   */
  double cohesion;
  /*
   Work of adhesion of balls with balls and planes, J/m^2.
   */
  double adhesion_energy;
  /*
   Volume of the liquid bridges of balls that have touched, m^3; 0: no bridges.
   */
  double bridge_volume;
  /*
   Surface tension of the bridges, N/m.
   */
  double bridge_tension;
  /*
   Contact angle of the bridges, from 0 to below pi/2, rad.
   */
  double bridge_angle;
} FemdemLaw;

/*
 Contacts of many bodies that the caller moves.
 */
typedef struct {
  /*
   Its number; 0 is none.
   */
  uint64_t id;
} FemdemBatch;

/*
 A shape. It never changes: any number of threads may use it at a time. Bodies keep what they need of it: it may be freed
 before them.
 */
typedef struct {
  /*
   Its number; 0 is none.
   */
  uint64_t id;
} FemdemShape;

/*
 A plane with bodies on one side of it.
 */
typedef struct {
  /*
   Direction towards the bodies, of any length above 0.
   */
  double normal[3];
  /*
   Its product with a point of the plane: with a normal of length 1 the distance from the origin, m.
   */
  double offset;
} FemdemPlane;

/*
 A box with bodies inside.
 */
typedef struct {
  /*
   Lowest corner, m.
   */
  double low[3];
  /*
   Highest corner, m.
   */
  double high[3];
} FemdemBox;

/*
 The numbers of the six walls of a box.
 */
typedef struct {
  /*
   The walls that bodies meet towards lower x, y and z.
   */
  uint32_t low[3];
  /*
   Those towards higher x, y and z.
   */
  uint32_t high[3];
} FemdemSides;

/*
 Sums over the contacts of a batch.
 */
typedef struct {
  /*
   Energy of the normal contacts, J.
   */
  double energy;
  /*
   Energy in the friction springs, J.
   */
  double spring_energy;
  /*
   Largest stable step of leapfrog for the contacts of the last update, s; infinite without contacts. Take a small part of
   it: contacts that begin are stiffer.
   */
  double stable_step;
  /*
   Pairs near each other.
   */
  size_t candidates;
  /*
   Pairs in touch.
   */
  size_t touching;
} FemdemBatchTotals;

/*
 A force and a torque, in world axes.
 */
typedef struct {
  /*
   N.
   */
  double force[3];
  /*
   About the centroid of a body, the origin of a wall, N m.
   */
  double torque[3];
} FemdemLoad;

/*
 A contact, in one patch, of a body or wall A and a body B. Vectors are in world axes.
 */
typedef struct {
  /*
   Number of the body or wall A.
   */
  uint32_t a;
  /*
   Number of the body B.
   */
  uint32_t b;
  /*
   1 if A is a wall, else 0.
   */
  int32_t a_is_wall;
  /*
   Number of the patch, from 0: bodies that are not convex may touch in several.
   */
  uint32_t patch;
  /*
   1 if it slides, else 0.
   */
  int32_t slides;
  /*
   Centre of pressure, m.
   */
  double point[3];
  /*
   Unit vector from A to B.
   */
  double normal[3];
  /*
   Whole force on B, N; A bears the opposite.
   */
  double force[3];
  /*
   Its part across the normal, N.
   */
  double friction[3];
  /*
   Its part along the normal, N; negative where it pulls.
   */
  double normal_force;
  /*
   Contact area, m^2.
   */
  double area;
  /*
   Overlap volume, m^3.
   */
  double volume;
  /*
   Energy of the normal contact, J.
   */
  double energy;
  /*
   Normal stiffness, N/m.
   */
  double stiffness;
} FemdemContact;

/*
 Where a body is: the coordinates of its shape, whose origin is the centroid, turned and then moved.
 */
typedef struct {
  /*
   Of the centroid, m.
   */
  double position[3];
  /*
   Quaternion w, x, y, z, of length 1 to 1e-6.
   */
  double rotation[4];
} FemdemPose;

/*
 How a body moves, in world axes.
 */
typedef struct {
  /*
   Of the centroid, m/s.
   */
  double linear[3];
  /*
   rad/s.
   */
  double angular[3];
} FemdemVelocity;

/*
 Where a body is and how it moves.
 */
typedef struct {
  /*
   Where it is.
   */
  FemdemPose pose;
  /*
   How it moves.
   */
  FemdemVelocity velocity;
} FemdemMotion;

/*
 Bodies in motion.
 */
typedef struct {
  /*
   Its number; 0 is none.
   */
  uint64_t id;
} FemdemWorld;

/*
 What deformable bodies are made of. Begin with femdem_matter_default. What its law has no use for is not read.
 */
typedef struct {
  /*
   In the reference state, kg/m^3.
   */
  double density;
  /*
   Young's modulus, Pa.
   */
  double young;
  /*
   Poisson's ratio, above -1 and below 0.5.
   */
  double poisson;
  /*
   Shear viscosity beside any law, Pa s.
   */
  double shear_viscosity;
  /*
   Bulk viscosity beside any law, Pa s.
   */
  double bulk_viscosity;
  /*
   Stiffness of the contacts over that of the body: with 1 they cost 5 % of the force of a Hertz contact.
   */
  double contact_ratio;
  /*
   Mooney-Rivlin: share of the second invariant in the shear modulus, from 0 to 1.
   */
  double share;
  /*
   J2: yield stress, Pa.
   */
  double yield_stress;
  /*
   J2: hardening modulus, Pa.
   */
  double hardening;
  /*
   J2: yield stress at large plastic strain, Pa, approached exponentially; NaN, the default: none.
   */
  double saturation_stress;
  /*
   J2: rate at which that is approached, per unit of plastic strain.
   */
  double saturation_rate;
  /*
   Drucker-Prager: cohesion of Mohr-Coulomb, Pa.
   */
  double cohesion;
  /*
   Drucker-Prager: angle of friction of Mohr-Coulomb, rad.
   */
  double friction_angle;
  /*
   Drucker-Prager: angle of dilatancy, rad.
   */
  double dilatancy_angle;
  /*
   One of the FEMDEM_MATTER constants.
   */
  int32_t law;
  /*
   One of the FEMDEM_ELEMENT constants.
   */
  int32_t element;
} FemdemMatter;

/*
 How bodies break. Begin with femdem_fracture_default.
 */
typedef struct {
  /*
   Tensile strength, Pa.
   */
  double tensile;
  /*
   Cohesion of Mohr-Coulomb, Pa.
   */
  double cohesion;
  /*
   Angle of friction of Mohr-Coulomb, rad.
   */
  double friction_angle;
  /*
   Energy of fracture by opening, J/m^2.
   */
  double opening_energy;
  /*
   Energy of fracture by sliding, J/m^2, at least that by opening.
   */
  double sliding_energy;
  /*
   Exponent of mixed modes.
   */
  double mix;
  /*
   Stiffness of a new crack over E/h, with Young's modulus E and the height h of the elements.
   */
  double stiffness;
  /*
   Weibull's modulus of the scatter of the strength, at least 1; 0: none.
   */
  double weibull_modulus;
  /*
   The volume whose characteristic strength is that above, m^3.
   */
  double weibull_volume;
  /*
   Seed of the scatter.
   */
  uint64_t weibull_seed;
  /*
   Steps between two looks at the stresses.
   */
  uint32_t every;
  /*
   One of the FEMDEM_SOFTENING constants.
   */
  int32_t softening;
  /*
   1: the mesh may be coarser than cracks need that take their energy and no more; 0: it is refused.
   */
  int32_t coarse;
  /*
   1: the parts stay one body; 0: femdem_world_fragment_bodies makes bodies of them.
   */
  int32_t pieces;
} FemdemFracture;

/*
 The elastic contact of two bodies, without friction and damping.
 */
typedef struct {
  /*
   On body A.
   */
  FemdemLoad on_a;
  /*
   On body B.
   */
  FemdemLoad on_b;
  /*
   Contact energy, J: the forces are minus its gradient.
   */
  double energy;
  /*
   Volume of the overlap, m^3.
   */
  double volume;
  /*
   Contact area, m^2, the sum of that of the patches.
   */
  double area;
  /*
   Normal stiffness, N/m, the sum of that of the patches.
   */
  double stiffness;
  /*
   Connected parts of the overlap: 0 if the bodies are apart.
   */
  uint32_t patches;
} FemdemPair;

/*
 A shape as numbers.
 */
typedef struct {
  /*
   m^3.
   */
  double volume;
  /*
   Of the surface, m^2.
   */
  double area;
  /*
   Largest distance of a point from the centroid, m.
   */
  double radius;
  /*
   Where the centroid was in the coordinates that were given, m. In those of the shape it is the origin.
   */
  double centroid[3];
  /*
   Inertia tensor about the centroid at a density of 1 kg/m^3, row by row, kg m^2.
   */
  double inertia[9];
  /*
   0: convex, 1: an exact ball, 2: filled with tetrahedra.
   */
  int32_t kind;
  /*
   Vertices of the surface; of a ball, of its picture.
   */
  uint32_t vertex_count;
  /*
   Triangles of the surface; of a ball, of its picture.
   */
  uint32_t triangle_count;
} FemdemShapeProperties;

/*
 How a bond holds and breaks, per area of its section. Begin with femdem_bond_law_default.
 */
typedef struct {
  /*
   Along and across the normal, Pa/m: Young's modulus over the thickness.
   */
  double stiffness;
  /*
   Tensile strength, Pa.
   */
  double tensile;
  /*
   Shear strength without pressure, Pa.
   */
  double cohesion;
  /*
   Coefficient of friction, of the strength under pressure and of the broken faces.
   */
  double friction;
  /*
   Energy of fracture by opening, J/m^2.
   */
  double opening_energy;
  /*
   Energy of fracture by sliding, J/m^2.
   */
  double sliding_energy;
  /*
   Exponent of mixed modes.
   */
  double mix;
  /*
   Part of the critical damping of the two bodies along the normal, from 0 to below 10.
   */
  double damping;
  /*
   One of the FEMDEM_SOFTENING constants.
   */
  int32_t softening;
} FemdemBondLaw;

/*
 A bond between the bodies A and B. Vectors are in world axes.
 */
typedef struct {
  /*
   Its number.
   */
  uint32_t bond;
  /*
   Number of the body A.
   */
  uint32_t a;
  /*
   Number of the body B.
   */
  uint32_t b;
  /*
   1 if nothing holds any more, else 0.
   */
  int32_t broken;
  /*
   1 if it carries nothing any more and the bodies meet by their contacts again, else 0.
   */
  int32_t ended;
  /*
   m^2.
   */
  double area;
  /*
   Centroid of the section midway between its sides, m.
   */
  double centre[3];
  /*
   Unit vector from A to B.
   */
  double normal[3];
  /*
   With which B pulls A, without dashpots, N: along the normal in tension.
   */
  double force[3];
  /*
   Of B on A about the centre, without dashpots, N m.
   */
  double moment[3];
  /*
   Largest normal traction, Pa.
   */
  double tension;
  /*
   Stored energy, J.
   */
  double energy;
  /*
   Dissipated by fracture and friction, J.
   */
  double dissipated;
  /*
   Part of the stiffness that is lost: 0 whole, 1 broken.
   */
  double damage;
  /*
   Part of sliding in what gave way: 0 by opening, 1 by sliding.
   */
  double mode;
  /*
   When it was found broken, s; NaN if it is not.
   */
  double broken_at;
} FemdemBond;

/*
 A matrix.
 */
typedef struct {
  /*
   Row by row.
   */
  double rows[9];
} FemdemMatrix;

/*
 A facet of a breakable body that is cut.
 */
typedef struct {
  /*
   The tetrahedra beside it; -1: one of another body, which has the facet, too.
   */
  int64_t tets[2];
  /*
   Its three corners midway between its sides, m.
   */
  double corners[9];
  /*
   Mean opening of its sides, m.
   */
  double opening;
  /*
   Mean slip of its sides, m.
   */
  double slip;
  /*
   0 when it is cut, 1 when nothing holds any more.
   */
  double damage;
  /*
   When it was cut, s.
   */
  double birth;
  /*
   When nothing held any more, s; NaN before.
   */
  double broken_at;
  /*
   Energy that it has taken to break, without friction, J.
   */
  double dissipated;
  /*
   1 if it was cut by shear, 0 if by tension.
   */
  int32_t sheared;
} FemdemCrack;

/*
 A fragment that has become a body.
 */
typedef struct {
  /*
   Number of the body.
   */
  uint32_t body;
  /*
   Number of the body that it was a part of, which is the largest of its fragments now.
   */
  uint32_t of;
} FemdemFragment;

/*
 A motion whatever touches, counted from where the wall, body or node is when it is given. What its kind has no use for is not read.
 */
typedef struct {
  /*
   One of the FEMDEM_DRIVE constants.
   */
  int32_t kind;
  /*
   Of a shake.
   */
  uint32_t periods;
  /*
   Velocity, stroke or axis.
   */
  double vector[3];
  /*
   A point of the axis, m.
   */
  double point[3];
  /*
   rad/s.
   */
  double rate;
  /*
   1/s.
   */
  double frequency;
  /*
   s.
   */
  double start;
  /*
   s; infinite: for ever.
   */
  double end;
} FemdemDrive;

/*
 A deformable body as numbers. Those that break get more nodes, and may get fewer tetrahedra by femdem_world_fragment_bodies.
 */
typedef struct {
  /*
   kg.
   */
  double mass;
  /*
   Centre of mass, m.
   */
  double centroid[3];
  /*
   Velocity of that, m/s.
   */
  double velocity[3];
  /*
   J.
   */
  double kinetic_energy;
  /*
   Elastic energy, J, without that of its cracks.
   */
  double strain_energy;
  /*
   Nodes.
   */
  size_t node_count;
  /*
   Tetrahedra.
   */
  size_t tet_count;
  /*
   Triangles of its skin.
   */
  size_t triangle_count;
  /*
   Number of its model.
   */
  uint32_t model;
  /*
   1 if it may break, else 0.
   */
  int32_t breakable;
  /*
   1 if it is frozen, else 0.
   */
  int32_t asleep;
} FemdemDeformable;

/*
 What a world needs to know besides its bodies and walls. Begin with femdem_world_defaults.
 */
typedef struct {
  /*
   Acceleration of gravity, m/s^2.
   */
  double gravity[3];
  /*
   The law of all pairs of materials without one of their own.
   */
  FemdemLaw law;
  /*
   Part of the largest stable step that is taken, from 1e-6 to 1.
   */
  double safety;
  /*
   Upper limit of the step, s; infinite: none.
   */
  double largest_step;
  /*
   Rate of drag, 1/s.
   */
  double drag;
  /*
   Part by which the net force is reduced against the motion, from 0 to below 1.
   */
  double local_damping;
  /*
   Net force of a body at rest over its weight, from 1e-12 to 0.06.
   */
  double sleep_tolerance;
  /*
   Steps over which rest is judged, at least 10.
   */
  uint32_t sleep_window;
  /*
   Whether bodies at rest are frozen: 0 or 1.
   */
  int32_t sleeping;
  /*
   Whether steps are linearly implicit, which brings packs to rest faster: 0 or 1.
   */
  int32_t implicit;
} FemdemWorldParameters;

/*
 How far a world has come.
 */
typedef struct {
  /*
   s.
   */
  double time;
  /*
   The present step, s; 0 before the first.
   */
  double time_step;
  /*
   The stability bound that it was chosen from, s; infinite without contact.
   */
  double stable_step;
  /*
   Largest net force on a body over the larger of its weight and its mean contact force: how far from balance.
   */
  double residual;
  /*
   Steps taken.
   */
  uint64_t steps;
  /*
   Rigid bodies.
   */
  size_t body_count;
  /*
   Deformable bodies.
   */
  size_t deformable_count;
  /*
   Bodies that are not frozen.
   */
  size_t awake_count;
  /*
   Walls.
   */
  size_t wall_count;
} FemdemWorldState;

/*
 Where all energy came from and went, J.
 */
typedef struct {
  /*
   Of all bodies when they were added.
   */
  double initial;
  /*
   What the caller has put in by hand.
   */
  double by_hand;
  /*
   Work of what is driven.
   */
  double work_in;
  /*
   Work of loads.
   */
  double load_work;
  /*
   Lent to cracks at their births; it comes back in what they dissipate.
   */
  double lent;
  /*
   Kinetic energy now.
   */
  double kinetic;
  /*
   Potential energy in gravity now, about the origin.
   */
  double potential;
  /*
   Energy of the normal contacts now.
   */
  double elastic;
  /*
   Elastic energy inside deformable bodies now.
   */
  double strain;
  /*
   Energy of the friction springs now.
   */
  double friction_springs;
  /*
   Energy in the cracks of bodies now.
   */
  double cracks;
  /*
   Energy in bonds now.
   */
  double bonds;
  /*
   Dissipated by friction.
   */
  double dissipated_friction;
  /*
   Dissipated by normal dashpots.
   */
  double dissipated_damping;
  /*
   Dissipated by drag and local damping.
   */
  double dissipated_medium;
  /*
   Dissipated by the viscosity of matter.
   */
  double dissipated_viscous;
  /*
   Dissipated by plastic flow.
   */
  double dissipated_plastic;
  /*
   Dissipated where liquid bridges broke.
   */
  double dissipated_bridges;
  /*
   Dissipated by breaking: less what was lent, this is the energy of fracture.
   */
  double dissipated_fracture;
  /*
   Dissipated by breaking bonds.
   */
  double dissipated_bonds;
  /*
   Dissipated as the pressure of new cracks fades, by contacts whose field cracks change, and where bonds ended.
   */
  double dissipated_release;
  /*
   Dissipated by implicit steps.
   */
  double dissipated_step;
  /*
   Kinetic energy removed when bodies were frozen.
   */
  double frozen;
  /*
   Exchanged so far.
   */
  double exchanged;
  /*
   All that was dissipated.
   */
  double dissipated;
  /*
   All energy now, plus what was dissipated, minus all that was put in: the error of the time integration.
   */
  double error;
  /*
   The same over the energy that was exchanged.
   */
  double error_relative;
} FemdemLedger;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The number of the interface of the library that is loaded: compare it with FEMDEM_ABI_VERSION of the header.
 */
uint32_t femdem_abi(void);

/*
 The version of femdem, such as "0.1.0".
 */
const char *femdem_version(void);

/*
 Makes an empty batch with a law for all materials.
 */
FemdemStatus femdem_batch_new(const FemdemLaw *law, FemdemBatch *batch);

/*
 Gives a batch threads of its own; 0: those of the process again. Results are the same bits for any number.
 */
FemdemStatus femdem_batch_set_threads(FemdemBatch batch,
                                      uint32_t threads);

/*
 Gives two materials, from 0 to 255, or a material and itself, a law of their own; null: that of the batch again.
 */
FemdemStatus femdem_batch_set_law(FemdemBatch batch,
                                  uint32_t material_a,
                                  uint32_t material_b,
                                  const FemdemLaw *law);

/*
 Adds a body with the mass and the inertia of a density in kg/m^3; 0: a body that contacts do not move. Its number is the
 lowest that is free.
 */
FemdemStatus femdem_batch_add_body(FemdemBatch batch,
                                   FemdemShape shape,
                                   double density,
                                   uint32_t material_id,
                                   uint32_t *body);

/*
 Gives a body another mass in kg and another inertia about its centroid: nine numbers in kg m^2, row by row, in its own axes.
 Dashpots and the stable step need them.
 */
FemdemStatus femdem_batch_set_mass(FemdemBatch batch,
                                   uint32_t body,
                                   double mass,
                                   const double *inertia,
                                   size_t count);

/*
 Removes a body with its contacts. Its number is given to the next body, unless a lower one is free.
 */
FemdemStatus femdem_batch_remove_body(FemdemBatch batch, uint32_t body);

/*
 Ends the contacts of a body with their friction, because it was put somewhere else.
 */
FemdemStatus femdem_batch_forget_contacts(FemdemBatch batch, uint32_t body);

/*
 Adds a plane wall.
 */
FemdemStatus femdem_batch_add_plane(FemdemBatch batch,
                                    const FemdemPlane *plane,
                                    uint32_t material_id,
                                    uint32_t *wall);

/*
 Adds the six walls of a box. `sides` may be null.
 */
FemdemStatus femdem_batch_add_box(FemdemBatch batch,
                                  const FemdemBox *inside,
                                  uint32_t material_id,
                                  FemdemSides *sides);

/*
 Adds a wall of triangles, of a thickness in m behind them: bodies are where the triangles are counter-clockwise. Vertices
 and triangles as in femdem_shape_surface.
 */
FemdemStatus femdem_batch_add_sheet(FemdemBatch batch,
                                    const double *vertices,
                                    size_t vertex_count,
                                    const uint32_t *triangles,
                                    size_t triangle_count,
                                    double thickness,
                                    uint32_t material_id,
                                    uint32_t *wall);

/*
 Removes a wall with its contacts.
 */
FemdemStatus femdem_batch_remove_wall(FemdemBatch batch, uint32_t wall);

/*
 Writes the sums of the last update.
 */
FemdemStatus femdem_batch_totals(FemdemBatch batch, FemdemBatchTotals *totals);

/*
 Writes the loads on the walls about their origins, by number.
 */
FemdemStatus femdem_batch_wall_loads(FemdemBatch batch, FemdemLoad *loads, size_t count);

/*
 Writes the number of contacts of the last update, and the contacts if `room` is not 0: then it must suffice for all.
 */
FemdemStatus femdem_batch_contacts(FemdemBatch batch,
                                   FemdemContact *contacts,
                                   size_t room,
                                   size_t *count);

/*
 Writes how many numbers of bodies and of walls have been in use: the lengths of the arrays of femdem_batch_update and
 femdem_batch_wall_loads. Either may be null.
 */
FemdemStatus femdem_batch_slots(FemdemBatch batch,
                                size_t *bodies,
                                size_t *walls);

/*
 Finds all contacts where the bodies are now, and writes the load on each.

 Motions and loads are by the numbers of the bodies; what stands at a number not in use is not read. `dt` is the time since
 the last update in s, 0 in the first. Velocities are those of the half step before, as leapfrog has them: dashpots allow for
 it.
 */
FemdemStatus femdem_batch_update(FemdemBatch batch,
                                 const FemdemMotion *motions,
                                 size_t motion_count,
                                 double dt,
                                 FemdemLoad *loads,
                                 size_t load_count);

/*
 Puts a wall at a pose of the coordinates in which it was added; its velocity is that of their origin. Both count from the next
 update on, and stay until the next call.
 */
FemdemStatus femdem_batch_move_wall(FemdemBatch batch,
                                    uint32_t wall,
                                    const FemdemMotion *motion);

/*
 The message of the last call of this thread that failed; empty if none has. At most 1,023 bytes of UTF-8, valid until the
 next call of this thread that fails.
 */
const char *femdem_last_error(void);

/*
 Frees a shape; does nothing with a handle of 0. Its memory stays as long as a batch or a world lives that has had a body of
 it: make a shape once for all its bodies.
 */
FemdemStatus femdem_shape_free(FemdemShape shape);

/*
 Frees a batch; does nothing with a handle of 0.
 */
FemdemStatus femdem_batch_free(FemdemBatch batch);

/*
 Frees a world; does nothing with a handle of 0.
 */
FemdemStatus femdem_world_free(FemdemWorld world);

/*
 Writes the default law: a penalty of 1e6 Pa, which is right for no material in particular, a friction of 0.6 and a damping
 ratio of 0.6.
 */
FemdemStatus femdem_law_default(FemdemLaw *law);

/*
 Writes the default matter: a rubber of 1100 kg/m^3, 1 MPa and a Poisson's ratio of 0.45, in linear tetrahedra.
 */
FemdemStatus femdem_matter_default(FemdemMatter *matter);

/*
 Writes the default fracture: a concrete of 3 MPa and 90 J/m^2.
 */
FemdemStatus femdem_fracture_default(FemdemFracture *fracture);

/*
 Writes what two bodies do to each other under a penalty in Pa: all zeros if they are apart. It keeps no state.
 */
FemdemStatus femdem_pair_evaluate(double penalty,
                                  FemdemShape a,
                                  const FemdemPose *pose_a,
                                  FemdemShape b,
                                  const FemdemPose *pose_b,
                                  FemdemPair *pair);

/*
 Makes a shape by its name, such as "cube", "A10", "dolos" or "box:width=0.5", of a size in m. What the size of a shape
 is stands in the book: of solids it is the diameter of the sphere around them. A "sphere" without a level is the exact ball.
 */
FemdemStatus femdem_shape_named(const char *name,
                                double size,
                                double mesh_size,
                                FemdemShape *shape);

/*
 Makes a shape of a closed surface: `vertex_count` vertices, three coordinates in m each, and `triangle_count` triangles,
 three numbers of vertices each, counter-clockwise from outside. Any shape will do; triangles in one plane become one face.
 `mesh_size` is the size of the tetrahedra of a body that is not convex over its diameter; 0: chosen.
 */
FemdemStatus femdem_shape_surface(const double *vertices,
                                  size_t vertex_count,
                                  const uint32_t *triangles,
                                  size_t triangle_count,
                                  double mesh_size,
                                  FemdemShape *shape);

/*
 Makes the convex hull of `count` points, three coordinates in m each.
 */
FemdemStatus femdem_shape_hull(const double *vertices, size_t count, FemdemShape *shape);

/*
 Makes a shape of a file (STL, OBJ, OFF or PLY) with one closed surface. `unit` is the length in m of 1 in the file, 0.001 for
 millimetres.
 */
FemdemStatus femdem_shape_file(const char *path,
                               double unit,
                               double mesh_size,
                               FemdemShape *shape);

/*
 Writes the properties of a shape.
 */
FemdemStatus femdem_shape_properties(FemdemShape shape, FemdemShapeProperties *properties);

/*
 Writes the surface of a shape: three coordinates for each of its vertices, about the centroid, and three numbers of vertices
 for each of its triangles. The counts are those of femdem_shape_properties.
 */
FemdemStatus femdem_shape_triangles(FemdemShape shape,
                                    double *vertices,
                                    size_t vertex_count,
                                    uint32_t *triangles,
                                    size_t triangle_count);

/*
 Writes the default law of bonds: a mortar.
 */
FemdemStatus femdem_bond_law_default(FemdemBondLaw *law);

/*
 Bonds two bodies as they lie, without force, over a flat, convex polygon: its corners in order, in world coordinates, three
 numbers each. Their contacts end; the bond alone acts between them until it has ended. It goes with its bodies. Steps must
 be explicit.
 */
FemdemStatus femdem_world_add_bond(FemdemWorld world,
                                   uint32_t body_a,
                                   uint32_t body_b,
                                   const double *corners,
                                   size_t corner_count,
                                   const FemdemBondLaw *law,
                                   uint32_t *bond);

/*
 The same over the section that two balls or two convex polyhedra have between them which are at most `gap` m apart: of balls
 a disc of `ratio` times the smaller radius, of polyhedra the common part of facing faces, shrunk by `ratio`. Refuses others,
 and bodies that are bonded already.
 */
FemdemStatus femdem_world_add_bond_between(FemdemWorld world,
                                           uint32_t body_a,
                                           uint32_t body_b,
                                           double gap,
                                           double ratio,
                                           const FemdemBondLaw *law,
                                           uint32_t *bond);

/*
 Writes the number of bonds, and the bonds, ascending, if `room` is not 0: then it must suffice for all. Those that have ended
 are among them.
 */
FemdemStatus femdem_world_bonds(FemdemWorld world,
                                FemdemBond *bonds,
                                size_t room,
                                size_t *count);

/*
 Adds a body of a density in kg/m^3. Its number is the lowest that is free.
 */
FemdemStatus femdem_world_add_body(FemdemWorld world,
                                   FemdemShape shape,
                                   double density,
                                   const FemdemMotion *motion,
                                   uint32_t material_id,
                                   uint32_t *body);

/*
 Adds a plane wall.
 */
FemdemStatus femdem_world_add_plane(FemdemWorld world,
                                    const FemdemPlane *plane,
                                    uint32_t material_id,
                                    uint32_t *wall);

/*
 Adds the six walls of a box. `sides` may be null.
 */
FemdemStatus femdem_world_add_box(FemdemWorld world,
                                  const FemdemBox *inside,
                                  uint32_t material_id,
                                  FemdemSides *sides);

/*
 Adds a wall of triangles, of a thickness in m behind them: bodies are where the triangles are counter-clockwise. Vertices
 and triangles as in femdem_shape_surface.
 */
FemdemStatus femdem_world_add_sheet(FemdemWorld world,
                                    const double *vertices,
                                    size_t vertex_count,
                                    const uint32_t *triangles,
                                    size_t triangle_count,
                                    double thickness,
                                    uint32_t material_id,
                                    uint32_t *wall);

/*
 Makes the space of a world periodic over these lengths, m; infinite: not along that axis. Before its bodies and without walls
 across.
 */
FemdemStatus femdem_world_set_cell(FemdemWorld world,
                                   double x,
                                   double y,
                                   double z);

/*
 Lets the edges of the cell, which are columns, move with velocities in m/s, and all free bodies with space.
 */
FemdemStatus femdem_world_deform_cell(FemdemWorld world,
                                      const FemdemMatrix *rates);

/*
 Writes the edges of the cell as columns, m.
 */
FemdemStatus femdem_world_cell(FemdemWorld world, FemdemMatrix *edges);

/*
 Writes the mean stress in a cell that repeats itself along all axes, Pa, positive in compression.
 */
FemdemStatus femdem_world_cell_stress(FemdemWorld world, FemdemMatrix *stress);

/*
 Writes the number of the facets of a breakable body that are cut, and the facets if `room` is not 0: then it must suffice for
 all. Those that carry nothing any more come first.
 */
FemdemStatus femdem_world_cracks(FemdemWorld world,
                                 uint32_t body,
                                 FemdemCrack *cracks,
                                 size_t room,
                                 size_t *count);

/*
 Writes the number of tetrahedra of a breakable body, and the fragment that each belongs to, from 0, if `room` is not 0: then it
 must suffice for all. Facets that are not broken join them.
 */
FemdemStatus femdem_world_fragments(FemdemWorld world,
                                    uint32_t body,
                                    uint32_t *fragments,
                                    size_t room,
                                    size_t *count);

/*
 Makes bodies of the fragments of all bodies that have fallen into some, and writes how many there are besides the largest of
 each, which keep the numbers of the bodies. femdem_world_new_fragments tells which. A caller may ask after every step.
 */
FemdemStatus femdem_world_fragment_bodies(FemdemWorld world,
                                          size_t *count);

/*
 Writes the number of bodies that the last femdem_world_fragment_bodies has made, and which, if `room` is not 0: then it must
 suffice for all.
 */
FemdemStatus femdem_world_new_fragments(FemdemWorld world,
                                        FemdemFragment *fragments,
                                        size_t room,
                                        size_t *count);

/*
 Makes a model of deformable bodies from tetrahedra: `point_count` points, three coordinates in m each, and `tet_count`
 tetrahedra, four numbers of points each, the last on the side from which the first three are clockwise. Its points are its
 first nodes, in the coordinates that are given; quadratic elements add those in the middle of edges. Bodies of one shape and
 matter share a model, which stays as long as the world.
 */
FemdemStatus femdem_world_add_model(FemdemWorld world,
                                    const double *points,
                                    size_t point_count,
                                    const uint32_t *tets,
                                    size_t tet_count,
                                    const FemdemMatter *matter,
                                    uint32_t *model);

/*
 Makes a model of a shape, which is filled with tetrahedra; `mesh_size` is their size over the diameter of the shape, 0: 0.2. Its
 origin is the centroid, and bodies have the mass that the surface of the shape encloses.
 */
FemdemStatus femdem_world_add_model_of_shape(FemdemWorld world,
                                             FemdemShape shape,
                                             double mesh_size,
                                             const FemdemMatter *matter,
                                             uint32_t *model);

/*
 Adds a deformable body of a model. The pose of `motion` takes the coordinates of the model to the world, and its velocities are
 those of the centroid. With a `fracture` it may break; null: it does not. Its number is the lowest that is free, of rigid
 bodies and deformable ones together.
 */
FemdemStatus femdem_world_add_deformable(FemdemWorld world,
                                         uint32_t model,
                                         const FemdemMotion *motion,
                                         const FemdemFracture *fracture,
                                         uint32_t material_id,
                                         uint32_t *body);

/*
 Moves nodes of a deformable body as prescribed along some axes, the sum of FEMDEM_AXIS constants, counted from where they are;
 a drive of FEMDEM_DRIVE_FIXED holds them. It replaces an earlier one of the same nodes and axes.
 */
FemdemStatus femdem_world_drive_nodes(FemdemWorld world,
                                      uint32_t body,
                                      const uint32_t *nodes,
                                      size_t node_count,
                                      uint32_t axes,
                                      const FemdemDrive *drive);

/*
 Sets all driven nodes of a deformable body free.
 */
FemdemStatus femdem_world_release(FemdemWorld world, uint32_t body);

/*
 Moves a wall as prescribed.
 */
FemdemStatus femdem_world_drive_wall(FemdemWorld world, uint32_t wall, const FemdemDrive *drive);

/*
 Moves a body as prescribed, whatever touches it; null: sets it free with the velocity that it has.
 */
FemdemStatus femdem_world_drive_body(FemdemWorld world, uint32_t body, const FemdemDrive *drive);

/*
 Writes the whole state into a file. The earlier file of that name stays until the new one is complete.
 */
FemdemStatus femdem_world_save(FemdemWorld world,
                               const char *path);

/*
 Makes a world of a file of femdem_world_save. It goes on with the same bits.
 */
FemdemStatus femdem_world_load(const char *path, FemdemWorld *world);

/*
 Writes how many bytes hold the whole state, and the bytes if `room` is not 0: then it must suffice for all.
 */
FemdemStatus femdem_world_to_bytes(FemdemWorld world,
                                   uint8_t *bytes,
                                   size_t room,
                                   size_t *count);

/*
 Makes a world of the bytes of femdem_world_to_bytes. It goes on with the same bits.
 */
FemdemStatus femdem_world_from_bytes(const uint8_t *bytes, size_t count, FemdemWorld *world);

/*
 Puts a body somewhere else; it keeps its velocity, and its contacts end.
 */
FemdemStatus femdem_world_set_pose(FemdemWorld world, uint32_t body, const FemdemPose *pose);

/*
 Gives a body another velocity; its contacts keep their friction.
 */
FemdemStatus femdem_world_set_velocity(FemdemWorld world,
                                       uint32_t body,
                                       const FemdemVelocity *velocity);

/*
 Loads a body, besides gravity, until it is given another load.
 */
FemdemStatus femdem_world_set_load(FemdemWorld world, uint32_t body, const FemdemLoad *load);

/*
 Removes a body with its contacts. Its number is given to the next body, unless a lower one is free.
 */
FemdemStatus femdem_world_remove_body(FemdemWorld world, uint32_t body);

/*
 Removes a wall with its contacts.
 */
FemdemStatus femdem_world_remove_wall(FemdemWorld world, uint32_t wall);

/*
 Writes the number of deformable bodies, and their numbers, ascending, if `room` is not 0: then it must suffice for all.
 */
FemdemStatus femdem_world_deformables(FemdemWorld world,
                                      uint32_t *bodies,
                                      size_t room,
                                      size_t *count);

/*
 Writes a deformable body as numbers.
 */
FemdemStatus femdem_world_deformable(FemdemWorld world,
                                     uint32_t body,
                                     FemdemDeformable *deformable);

/*
 Writes the positions of the nodes of a deformable body, m, three numbers each.
 */
FemdemStatus femdem_world_node_positions(FemdemWorld world,
                                         uint32_t body,
                                         double *positions,
                                         size_t count);

/*
 Writes the velocities of the nodes of a deformable body, m/s, three numbers each.
 */
FemdemStatus femdem_world_node_velocities(FemdemWorld world,
                                          uint32_t body,
                                          double *velocities,
                                          size_t count);

/*
 Writes the tetrahedra of a deformable body, four numbers of nodes each.
 */
FemdemStatus femdem_world_tets(FemdemWorld world, uint32_t body, uint32_t *tets, size_t count);

/*
 Writes the triangles of the skin of a deformable body, three numbers of nodes each, counter-clockwise from outside.
 */
FemdemStatus femdem_world_skin(FemdemWorld world,
                               uint32_t body,
                               uint32_t *triangles,
                               size_t count);

/*
 Writes the Cauchy stresses in the tetrahedra of a deformable body, Pa, tension positive: xx, yy, zz, xy, yz, zx each.
 */
FemdemStatus femdem_world_stresses(FemdemWorld world,
                                   uint32_t body,
                                   double *stresses,
                                   size_t count);

/*
 Writes the default parameters: gravity along -z, the default law, explicit steps, bodies that sleep.
 */
FemdemStatus femdem_world_defaults(FemdemWorldParameters *parameters);

/*
 Makes an empty world.
 */
FemdemStatus femdem_world_new(const FemdemWorldParameters *parameters, FemdemWorld *world);

/*
 Gives a world threads of its own; 0: those of the process again. Results are the same bits for any number.
 */
FemdemStatus femdem_world_set_threads(FemdemWorld world,
                                      uint32_t threads);

/*
 Gives two materials, from 0 to 255, or a material and itself, a law of their own; null: that of the parameters again.
 */
FemdemStatus femdem_world_set_law(FemdemWorld world,
                                  uint32_t material_a,
                                  uint32_t material_b,
                                  const FemdemLaw *law);

/*
 Replaces the acceleration of gravity, m/s^2. All bodies wake.
 */
FemdemStatus femdem_world_set_gravity(FemdemWorld world, double x, double y, double z);

/*
 Writes how far a world has come.
 */
FemdemStatus femdem_world_state(FemdemWorld world, FemdemWorldState *state);

/*
 Writes a hash of all that the next step depends on: equal for the same bits.
 */
FemdemStatus femdem_world_hash(FemdemWorld world, uint64_t *hash);

/*
 Writes the energy ledger.
 */
FemdemStatus femdem_world_ledger(FemdemWorld world, FemdemLedger *ledger);

/*
 Writes the number of bodies, and their numbers, ascending, if `room` is not 0: then it must suffice for all.
 */
FemdemStatus femdem_world_bodies(FemdemWorld world,
                                 uint32_t *bodies,
                                 size_t room,
                                 size_t *count);

/*
 Writes the number of bodies, and how they move, in the order of femdem_world_bodies, if `room` is not 0: then it must suffice
 for all.
 */
FemdemStatus femdem_world_motions(FemdemWorld world,
                                  FemdemMotion *motions,
                                  size_t room,
                                  size_t *count);

/*
 Writes how a body moves.
 */
FemdemStatus femdem_world_motion(FemdemWorld world, uint32_t body, FemdemMotion *motion);

/*
 Writes what the contacts do to a body.
 */
FemdemStatus femdem_world_body_load(FemdemWorld world, uint32_t body, FemdemLoad *load);

/*
 Writes what the contacts do to a wall, about its origin.
 */
FemdemStatus femdem_world_wall_load(FemdemWorld world, uint32_t wall, FemdemLoad *load);

/*
 Writes the number of contacts, and the contacts, sorted by pair and patch, if `room` is not 0: then it must suffice for all.
 */
FemdemStatus femdem_world_contacts(FemdemWorld world,
                                   FemdemContact *contacts,
                                   size_t room,
                                   size_t *count);

/*
 Takes `steps` steps; the world chooses their size. If one fails, those before it stay taken; with FEMDEM_STATUS_FAILED the
 world is of no further use.
 */
FemdemStatus femdem_world_step(FemdemWorld world,
                               uint64_t steps);

/*
 Takes steps until a time in s is reached, by at most one step more. If one fails, it is as in femdem_world_step.
 */
FemdemStatus femdem_world_step_until(FemdemWorld world,
                                     double time);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FEMDEM_H */
