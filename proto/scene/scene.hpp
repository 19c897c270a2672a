// The scene as plain data: what a user asks for, defaults filled in. SI units throughout.
//
// The member's initial value IS the documented default. Keys, units, ranges and texts stand once,
// in schema.hpp; every process reads the same resolved scene through it.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// A number, or a formula in x, y, z [m] and t [s] (proto/base/expression.hpp).
struct Formula {
  double number = 0;
  std::string text;  ///< empty: the number

  Formula() = default;
  Formula(double value) : number(value) {}  // NOLINT(google-explicit-constructor): a number is one
  bool operator==(const Formula&) const = default;
};

/// A vector of formulas.
struct VectorFormula {
  std::array<Formula, 3> components;

  VectorFormula() = default;
  VectorFormula(const Vector3& value)  // NOLINT(google-explicit-constructor): a vector is one
      : components{value.x(), value.y(), value.z()} {}
  bool operator==(const VectorFormula&) const = default;
};

// ---- scene, coupling, output, launch ----

struct SceneSettings {
  std::string name;
  Vector3 gravity{0, 0, -9.81};  ///< [m/s²]
  double end_time = 0;           ///< [s]
};

enum class Continuity { conservative, legacy };
enum class OnViolation { stop, warn };
enum class CouplingScheme { serial, parallel };

struct AuditSettings {
  double limit = 1e-10;  ///< largest accepted relative imbalance and cell residual [-]
  OnViolation on_violation = OnViolation::stop;
};

struct CouplingSettings {
  double window = 0;  ///< [s] one fluid step and one exchange
  CouplingScheme scheme = CouplingScheme::serial;
  Continuity continuity = Continuity::conservative;
  AuditSettings audit;
};

struct EverySettings {
  double every = 0;  ///< [s] between two records; 0: only start and end
};

struct OutputSettings {
  std::string directory;  ///< default: runs/<scene.name>
  EverySettings fields;
  EverySettings particles;
};

enum class LaunchMode { local, external };
enum class Security { none };

struct LaunchSettings {
  LaunchMode mode = LaunchMode::local;
  std::string listen;                ///< endpoint; default: a private ipc:// socket
  std::optional<Security> security;  ///< must be written out (none) to listen off loopback
  double deadline = 60;              ///< [s] silence of a participant after which it counts as lost
  double start_deadline = 30;        ///< [s] for all participants to say hello
};

// ---- fluid ----

enum class Side { x_min, x_max, y_min, y_max, z_min, z_max };

/// A range in each axis; what is not given is unbounded.
struct Region {
  std::optional<std::array<double, 2>> x, y, z;  ///< [m]
};

/// A part of an axis whose cells grow or shrink by a constant factor from one to the next.
struct GradingSettings {
  double length = 1;  ///< share of the axis, in relation to its other parts [-]
  double cells = 1;   ///< share of the cells likewise [-]
  double ratio = 1;   ///< width of the last cell over that of the first [-]
};

/// The parts of each axis from its lower end; none: equal cells.
struct BoxGrading {
  std::vector<GradingSettings> x, y, z;
};

struct BoxSettings {
  Vector3 lower{0, 0, 0};             ///< [m]
  Vector3 upper{0, 0, 0};             ///< [m]
  std::array<int, 3> cells{0, 0, 0};  ///< all 0: the mesh is not a box but comes from a file
  BoxGrading grading{};
};

struct PatchSettings {
  Side side = Side::x_min;
  Region within;
};

enum class Axis { x, y, z };

/// Two patches of a file that are one periodic pair.
struct JoinSettings {
  std::array<std::string, 2> patches;
};

/// A mesh from a file or folder. The coordinator reads it once and sends the mesh to the others.
struct MeshFileSettings {
  std::string path;  ///< absolute once load_scene has seen it
  double scale = 1;  ///< [m] for one unit of the file
  std::vector<JoinSettings> periodic;
};

/// Exactly one of `box`, `polymesh` and `gmsh`; `periodic` and `patches` belong to `box`.
struct MeshSettings {
  BoxSettings box;
  std::optional<MeshFileSettings> polymesh;
  std::optional<MeshFileSettings> gmsh;
  std::vector<Axis> periodic;
  std::vector<std::pair<std::string, PatchSettings>>
      patches;  ///< in the order of the file: the first that holds a face gets it

  bool is_box() const { return !polymesh && !gmsh; }
};

enum class BoundaryType { velocity, mass_flow, pressure, wall };
enum class Slip { none, free, partial };
enum class Along { time, x, y, z };

/// A table that multiplies a boundary value: linear between its points, constant beyond its ends.
struct ProfileSettings {
  Along along = Along::time;
  std::vector<std::array<double, 2>> points;  ///< [s or m, factor], the first column ascending
};

struct BoundarySettings {
  BoundaryType type = BoundaryType::wall;
  std::optional<VectorFormula>
      superficial;  ///< [m/s] type velocity: volume flux per area of the patch
  std::optional<VectorFormula>
      interstitial;  ///< [m/s] type velocity: multiplied by the voidage of the adjacent cell
  std::optional<Formula> rate;  ///< [kg/s] type mass_flow: into the domain, over the whole patch
  Formula value;                ///< [Pa] type pressure
  std::vector<ProfileSettings> profile;
  double ramp = 0;         ///< [s] over which the value grows from 0; 0: at once
  Slip slip = Slip::none;  ///< type wall
  double slip_length = 0;  ///< [m] slip: partial
  VectorFormula velocity;  ///< [m/s] type wall, slip: none | partial: of the wall along itself
};

struct InitialSettings {
  VectorFormula superficial;  ///< [m/s] at t = 0
};

enum class Convection { upwind, linear_upwind, limited };
enum class TimeScheme { euler, bdf2 };
enum class FluidBackend { native };
enum class LinearSolverChoice { automatic, multigrid, conjugate_gradient };

/// What carries the voidage in the mass source of the legacy continuity.
enum class LegacyVelocity { faces, cells };

/// The lagged mass source of the legacy continuity, and how far it is converged within a window.
struct LegacySettings {
  double tolerance =
      1e-4;  ///< largest change of a face flux between two iterations over the largest flux [-]
  int iterations = 20;
  LegacyVelocity velocity = LegacyVelocity::faces;
};

struct FluidNumerics {
  Convection convection = Convection::limited;
  TimeScheme time = TimeScheme::euler;
  double courant_limit = 5;  ///< [-] largest of any cell in an inner step
  int outer_iterations = 1;
  int correctors = 2;
  int non_orthogonal_correctors = 1;  ///< in each corrector, on meshes that are not orthogonal
  double pressure_tolerance = 1e-6;   ///< relative residual of the pressure equation [-]
  LinearSolverChoice solver = LinearSolverChoice::automatic;
  int threads = 0;  ///< 0: all cores of the machine
  LegacySettings legacy;
};

enum class ScalarKind { species, temperature };

/// What a patch does to a scalar.
struct ScalarBoundarySettings {
  std::optional<Formula> value;  ///< of what enters with the fluid, and at the wall
  std::optional<Formula>
      flux;  ///< into the domain through a wall: [kg/(m² s)] of a species, [W/m²] of heat
};

/// A field that the fluid carries, c per mass of fluid.
struct ScalarSettings {
  ScalarKind kind = ScalarKind::species;
  double diffusivity = 0;         ///< [m²/s] species: molecular
  double conductivity = 0;        ///< [W/(m K)] temperature: molecular
  double heat_capacity = 0;       ///< [J/(kg K)] temperature
  Formula initial;                ///< [c] at t = 0
  std::optional<Formula> source;  ///< per volume of fluid: [kg/(m³ s)] or [W/m³]
  std::map<std::string, ScalarBoundarySettings> boundaries;
  Convection convection = Convection::limited;
  double tolerance = 1e-10;  ///< residual of the linear solver over that of the step's start [-]
};

enum class TurbulenceModel { none, smagorinsky, k_epsilon };

/// Turbulence of what enters through a patch.
struct TurbulentInletSettings {
  double intensity = 0.05;  ///< fluctuation over mean velocity [-]
  double length_scale = 0;  ///< [m]
};

struct TurbulenceSettings {
  TurbulenceModel model = TurbulenceModel::none;
  double smagorinsky_constant = 0.17;  ///< [-]
  double kinetic_energy = 0;           ///< [m²/s²] k_epsilon: at time 0
  double dissipation = 0;              ///< [m²/s³] k_epsilon: at time 0
  double schmidt_number = 0.7;         ///< turbulent, of all scalars [-]
  std::map<std::string, TurbulentInletSettings> inlets;
};

struct FluidSettings {
  FluidBackend backend = FluidBackend::native;
  double density = 0;    ///< [kg/m³]
  double viscosity = 0;  ///< [Pa s]
  MeshSettings mesh;
  std::map<std::string, BoundarySettings> boundaries;
  InitialSettings initial;
  std::map<std::string, ScalarSettings> scalars;
  TurbulenceSettings turbulence;
  FluidNumerics numerics;
};

// ---- particles ----

/// native: our soft spheres. kinematic: no force moves them. hard_sphere: our events. lammps,
/// liggghts, yade: these engines. custom: a server program of somebody else.
enum class ParticleBackend { native, kinematic, hard_sphere, lammps, liggghts, yade, custom };
enum class ContactLaw { linear, hertz };
enum class RollingLaw { none, constant_torque, spring_dashpot };
enum class CohesionLaw { none, sjkr, jkr, liquid_bridge };

struct MaterialSettings {
  double density = 0;                    ///< [kg/m³]
  std::optional<double> youngs_modulus;  ///< [Pa] law hertz
  std::optional<double> poisson_ratio;   ///< [-] law hertz
};

/// Elasticity of all walls, law hertz.
struct WallMaterialSettings {
  double youngs_modulus = 0;  ///< [Pa]
  double poisson_ratio = 0;   ///< [-]
};

/// Which of the optional numbers are needed follows from `law`, `rolling` and `cohesion`.
struct PairSettings {
  std::array<std::string, 2> between;          ///< two materials, or a material and `walls`
  std::optional<double> normal_stiffness;      ///< [N/m] linear
  std::optional<double> tangential_stiffness;  ///< [N/m] linear; default 2/7 of the normal one
  double restitution = 0.9;                    ///< [-]
  double friction = 0.3;                       ///< [-]
  /// [-] hard_sphere; default: what the springs and dashpots of the linear law would give
  std::optional<double> tangential_restitution;
  std::optional<double> rolling_friction;  ///< [-] with a rolling law
  std::optional<double> rolling_damping;   ///< [-] spring_dashpot: share of critical; default 0.3
  std::optional<double> cohesion_energy_density;  ///< [J/m³] sjkr
  std::optional<double> work_of_adhesion;         ///< [J/m²] jkr
  std::optional<double> liquid_volume;            ///< [m³] liquid_bridge
  std::optional<double> surface_tension;          ///< [N/m] liquid_bridge
  std::optional<double> contact_angle;            ///< [rad] liquid_bridge
};

struct ContactSettings {
  ContactLaw law = ContactLaw::linear;
  RollingLaw rolling = RollingLaw::none;
  CohesionLaw cohesion = CohesionLaw::none;
  std::optional<WallMaterialSettings> walls;
  std::vector<PairSettings> pairs;
};

enum class InsertionType { packing, settled, lattice, file };
enum class Mobility { free, fixed };
enum class SizeDistribution { table, uniform, normal, lognormal };
enum class SizeWeight { number, mass };

/// How the diameters of spheres are spread.
struct SizeSettings {
  SizeDistribution distribution = SizeDistribution::table;
  SizeWeight by = SizeWeight::number;        ///< what the weights or the density count
  std::vector<std::array<double, 2>> table;  ///< [m], weight; the diameters ascend
  double mean = 0;                           ///< [m] normal: mean, lognormal: median
  double deviation = 0;  ///< normal: standard deviation over mean, lognormal: that of ln d [-]
  std::array<double, 2> range{0, 0};  ///< [m] all but table: none is outside
};

struct InsertionSettings {
  InsertionType type = InsertionType::packing;
  std::string material;
  double diameter = 0;                ///< [m] (file: a column of the file wins); 0: `sizes`
  std::optional<SizeSettings> sizes;  ///< packing, settled
  int count = 0;                      ///< packing, settled: particles
  double fraction = 0;                ///< the same as solid fraction of `within` [-]
  double number_density = 0;          ///< the same as particles per volume of `within` [1/m³]
  double height = 0;                  ///< [m] settled: of the bed above the bottom of `within`
  Region within;                      ///< default: the whole domain
  int seed = 1;                       ///< packing, settled
  double spacing = 0;         ///< [m] lattice: distance of neighbours; default 1.001 diameters
  Vector3 velocity{0, 0, 0};  ///< [m/s] packing, lattice
  Mobility motion = Mobility::free;
  std::string path;   ///< file
  std::string group;  ///< file: HDF5 group of the datasets; empty: found
};

/// Particles that come in during the run. Exactly one of `patch` and `within`, of `diameter` and
/// `sizes`, of the two rates.
struct InflowSettings {
  std::string patch;             ///< through its faces
  std::optional<Region> within;  ///< anywhere in this box
  std::string material;
  double diameter = 0;  ///< [m]
  std::optional<SizeSettings> sizes;
  double mass_rate = 0;        ///< [kg/s]
  double number_rate = 0;      ///< [1/s]
  Vector3 velocity{0, 0, 0};   ///< [m/s] of each as it comes in
  double start = 0;            ///< [s]
  std::optional<double> stop;  ///< [s]; default: never
  int seed = 1;
};

/// What to do with spheres that overlap at time 0 by more than a tenth of the smaller diameter.
enum class Overlaps { refuse, relax };

enum class WallSource { from_mesh, none };

enum class MotionType { none, translation, rotation, vibration };

/// How a surface moves as a rigid body. It stands as drawn at time 0; a vibration swings about
/// that place.
struct MotionSettings {
  MotionType type = MotionType::none;
  Vector3 velocity{0, 0, 0};   ///< [m/s] translation
  Vector3 point{0, 0, 0};      ///< [m] rotation: on the axis
  Vector3 direction{0, 0, 0};  ///< rotation: of the axis, of any length
  double rate = 0;             ///< [rad/s] rotation, right-handed about `direction`
  Vector3 amplitude{0, 0, 0};  ///< [m] vibration
  double frequency = 0;        ///< [Hz] vibration
  double phase = 0;            ///< [rad] vibration
};

enum class SurfaceType { plane, cylinder, cone, stl };
enum class SurfaceSide { both, inside, outside };

/// A wall of the particles beside those of the mesh.
struct SurfaceSettings {
  SurfaceType type = SurfaceType::plane;
  std::string material = "walls";        ///< in the pairs of particles.contact
  Vector3 point{0, 0, 0};                ///< [m] plane: on it; cylinder, cone: start of the axis
  Vector3 normal{0, 0, 0};               ///< plane: to the side of the particles, of any length
  Vector3 direction{0, 0, 0};            ///< cylinder, cone: of the axis, of any length
  double radius = 0;                     ///< [m] cylinder; cone: at `point`
  double end_radius = 0;                 ///< [m] cone: at its end
  double length = 0;                     ///< [m] along the axis; 0: an endless cylinder
  SurfaceSide side = SurfaceSide::both;  ///< where the insertion may place particles
  std::string path;                      ///< stl: absolute once load_scene has seen it
  double scale = 1;                      ///< stl: [m] for one unit of the file
  MotionSettings motion;
};
/// double: all numbers. mixed: positions in double, the rest of a particle and its contacts in
/// float.
enum class Precision { full, mixed };

struct ParticleNumerics {
  Precision precision = Precision::full;
  int threads = 0;  ///< 0: all cores of the machine
};

struct ParticleSettings {
  ParticleBackend backend = ParticleBackend::native;
  std::string program;   ///< custom: the server; absolute once load_scene has seen it
  int ranks = 1;         ///< MPI processes of the server
  double time_step = 0;  ///< [s] upper bound: the window is cut into equal sub-steps
  std::map<std::string, MaterialSettings> materials;
  ContactSettings contact;
  WallSource walls = WallSource::from_mesh;
  std::vector<std::pair<std::string, SurfaceSettings>> surfaces;
  std::vector<InsertionSettings> insertion;
  Overlaps overlaps = Overlaps::refuse;
  std::vector<InflowSettings> inflow;
  std::optional<std::vector<std::string>> outflow;  ///< patches; default: every open side
  ParticleNumerics numerics;
};

// ---- interphase ----

enum class VoidageMap { exact, centroid, satellite, kernel, diffusion, prescribed };
enum class DiffusedMap { exact, centroid };
enum class DragLaw {
  none,
  gidaspow,
  ergun,
  wen_yu,
  stokes,
  di_felice,
  koch_hill,
  beetstra,
  tang,
  syamlal_obrien,
  schiller_naumann,
  huilin_gidaspow,
  expression,
};
enum class InterphaseForce {
  pressure_gradient,
  viscous,
  added_mass,
  saffman_lift,
  magnus_lift,
  turbulent_dispersion,
  lubrication,
};
enum class Crowding { none, zuber };
enum class PressureModel { a, b };
enum class SelfDisturbance { none, corrected };

/// A solid phase given by a formula, at rest, without particles: for verification.
struct PrescribedSettings {
  std::string voidage;  ///< expression in x, y, z [m] (cell centre) and t [s]
  double diameter = 0;  ///< [m] of the spheres that the drag law sees
};

/// How the volume of a particle, and all that it exchanges with the fluid, is shared among cells.
/// A word alone in the scene is the map.
struct VoidageSettings {
  static constexpr std::string_view short_form = "map";

  VoidageMap map = VoidageMap::exact;
  int points = 32;                        ///< satellite: in a ball
  double width = 0;                       ///< [m] kernel, diffusion: at half of the maximum
  DiffusedMap from = DiffusedMap::exact;  ///< diffusion: what is spread
  double smallest = 0.2;                  ///< voidage of a cell that passes on what it cannot hold

  VoidageSettings() = default;
  VoidageSettings(VoidageMap chosen)  // NOLINT(google-explicit-constructor): a map is one
      : map(chosen) {}
};

/// The two constants of the law of Syamlal and O'Brien, tuned to a measured u_mf.
struct SyamlalObrienSettings {
  double dense_factor = 0.8;      ///< c of B = c ε^1.28, ε ≤ 0.85 [-]
  double dilute_exponent = 2.65;  ///< d of B = ε^d, ε > 0.85 [-]
};

struct DragConstantSettings {
  double value = 0;        ///< in `unit`
  std::string unit = "1";  ///< SI, proto/base/unit_formula.hpp
};

/// A drag law of the user's own.
struct DragExpressionSettings {
  std::string coefficient;  ///< ζ [kg/s] of one sphere, or β [kg/(m³ s)]: by its unit
  std::map<std::string, DragConstantSettings> constants;
  std::array<double, 2> voidage{0.2, 1};  ///< [-] where the check tries it
  std::array<double, 2> slip{0, 50};      ///< [m/s] where the check tries it
};

/// The film of fluid between surfaces that come close.
struct LubricationSettings {
  double roughness = 0;  ///< [m] the film is not thinner
  double reach = 0;      ///< [m] gap from which on it acts
};

struct InterphaseSettings {
  PressureModel model = PressureModel::a;
  VoidageSettings voidage;
  DragLaw drag = DragLaw::gidaspow;
  SyamlalObrienSettings syamlal_obrien;    ///< drag: syamlal_obrien
  DragExpressionSettings drag_expression;  ///< drag: expression
  SelfDisturbance self_disturbance = SelfDisturbance::none;
  std::vector<InterphaseForce> forces{InterphaseForce::pressure_gradient};
  Crowding added_mass_crowding = Crowding::none;
  int dispersion_seed = 1;
  LubricationSettings lubrication;  ///< forces: [lubrication]
  std::optional<PrescribedSettings> prescribed;
};

struct Scene {
  int version = 1;
  SceneSettings scene;
  CouplingSettings coupling;
  FluidSettings fluid;
  ParticleSettings particles;
  InterphaseSettings interphase;
  OutputSettings output;
  LaunchSettings launch;
};

/// Sub-steps of the particles in one window: the fewest equal steps not longer than
/// particles.time_step.
int sub_steps(const Scene& scene);

/// Windows from time 0 to end_time.
int windows(const Scene& scene);

/// Whether particles can come in or leave during the run: the particle side then says how many did,
/// and the audit has columns for it. They can leave where particles.outflow says so or, without
/// it, if there is a patch of type pressure or no wall at all.
bool particles_flow(const Scene& scene);

/// Whether there are particles at any time.
bool has_particles(const Scene& scene);

/// Whether the engine follows particles.contact at all, and whether it does so with springs, in
/// steps of time. Of a custom engine nothing is known.
bool knows_contacts(ParticleBackend backend);
bool knows_springs(ParticleBackend backend);

/// Whether interphase.forces names it.
bool has_force(const Scene& scene, InterphaseForce force);

}  // namespace fluxpact
