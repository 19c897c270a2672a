// The force of a contact in lanes against the same laws written out for one contact, and what holds
// for all laws: lanes, masks, precision.
#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/dem_server/native/one_contact.hpp"

namespace fluxpact {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

/// A contact and its springs at random: sticking and sliding, closing and opening.
struct RandomContact {
  Touch touch;
  Springs springs;
};

class RandomContacts {
 public:
  RandomContact next() {
    RandomContact one;
    one.touch.normal = direction();
    one.touch.overlap = 1e-5 * uniform(0.1, 1);
    one.touch.velocity = uniform(0, 0.1) * direction();
    one.touch.radius_spin = uniform(0, 0.1) * direction();
    one.touch.spin = uniform(0, 100) * direction();
    one.touch.inverse_mass = 1 / uniform(1e-6, 1e-5);
    one.touch.inverse_radius = 1 / uniform(2e-4, 2e-3);
    one.touch.inverse_inertia = 1 / uniform(1e-12, 1e-11);
    one.springs.tangential = uniform(0, 1e-5) * direction();
    one.springs.rolling = uniform(0, 0.1) * direction();
    one.springs.bridge = uniform(0, 1) < 0.5 ? 0 : 1;
    return one;
  }

 private:
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Vector3 direction() {
    return Vector3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
  }
  std::mt19937 random_{20261122};  // NOLINT: the same contacts every time
};

constexpr double dt = 1e-6;

/// Springs and dashpots of one contact, in the words of the theory.
struct Reference {
  double k, kt, c, ct, kept;
};

Reference linear_reference(const Touch& touch, double kn, double kt, double e) {
  const double mass = 1 / touch.inverse_mass;
  const double l = std::log(e);
  const double c = 2 * -l / std::sqrt(M_PI * M_PI + l * l) * std::sqrt(kn * mass);
  return {kn, kt, c, c / 2, 1};
}

Reference hertz_reference(const Touch& touch, double modulus, double nu, double e) {
  const double mass = 1 / touch.inverse_mass;
  const double radius = 1 / touch.inverse_radius;
  const double l = std::log(e);
  const double beta = -l / std::sqrt(M_PI * M_PI + l * l);
  const double effective = modulus / (2 * (1 - nu * nu));
  const double shear = modulus / (4 * (2 - nu) * (1 + nu));
  const double sn = 2 * effective * std::sqrt(radius * touch.overlap);
  const double st = 8 * shear * std::sqrt(radius * touch.overlap);
  const double before = touch.overlap + dt * touch.velocity.dot(touch.normal);
  return {4.0 / 3 * effective * std::sqrt(radius * touch.overlap), st,
          2 * std::sqrt(5.0 / 6) * beta * std::sqrt(sn * mass),
          2 * std::sqrt(5.0 / 6) * beta * std::sqrt(st * mass),
          before < touch.overlap ? std::sqrt(before / touch.overlap) : 1};
}

struct Expected {
  Vector3 force, lever, spring;
  bool slides;
};

Expected expected(const RandomContact& contact, const Reference& is, double mu) {
  const Touch& t = contact.touch;
  const double vn = t.velocity.dot(t.normal);
  const Vector3 slip = t.velocity - vn * t.normal - t.radius_spin.cross(t.normal);
  const double fn = is.k * t.overlap - is.c * vn;
  Vector3 xi = is.kept * contact.springs.tangential + dt * slip;
  xi -= xi.dot(t.normal) * t.normal;
  Vector3 ft = -is.kt * xi - is.ct * slip;
  const bool slides = ft.norm() > mu * std::abs(fn);
  if (slides) {
    ft *= mu * std::abs(fn) / ft.norm();
    xi = -(ft + is.ct * slip) / is.kt;
  }
  return {fn * t.normal + ft, -t.normal.cross(ft), xi, slides};
}

/// Compares 2000 random contacts; at least a tenth must slide and a tenth stick.
void compare(const ParticleSettings& settings, double mu,
             const std::function<Reference(const Touch&)>& reference) {
  const ContactLaws laws(settings);
  const auto table = law_table<double>(laws);
  RandomContacts random;
  int sliding = 0;
  for (int i = 0; i < 2000; ++i) {
    const RandomContact contact = random.next();
    const Reference is = reference(contact.touch);
    const Expected want = expected(contact, is, mu);
    const Pushed got = push(table, laws.index(0, 0), contact.touch, contact.springs, dt);
    sliding += want.slides ? 1 : 0;
    // Sums of a few terms of these sizes, each rounded a few times.
    const double speed = contact.touch.velocity.norm() + contact.touch.radius_spin.norm();
    const double length = contact.springs.tangential.norm() + dt * speed;
    const double size = is.k * contact.touch.overlap + (is.c + is.ct) * speed + is.kt * length;
    EXPECT_LT((got.force - want.force).norm(), 16 * eps * size) << i;
    EXPECT_LT((got.lever - want.lever).norm(), 16 * eps * size) << i;
    EXPECT_LT((got.springs.tangential - want.spring).norm(), 16 * eps * size / is.kt) << i;
  }
  EXPECT_GT(sliding, 200);
  EXPECT_LT(sliding, 1800);
}

TEST(ContactForce, linear_is_the_spring_and_dashpot_of_cundall_and_strack) {
  const auto settings = with(two_pairs(), [](PairSettings& pair) {
    pair.normal_stiffness = 1500;
    pair.tangential_stiffness = 700;
    pair.restitution = 0.7;
    pair.friction = 0.4;
  });
  compare(settings, 0.4,
          [](const Touch& touch) { return linear_reference(touch, 1500, 700, 0.7); });
}

TEST(ContactForce, hertz_is_that_of_hertz_mindlin_and_tsuji) {
  const auto settings = with(elastic(5e6, 0.3), [](PairSettings& pair) {
    pair.restitution = 0.7;
    pair.friction = 0.4;
  });
  compare(settings, 0.4, [](const Touch& touch) { return hertz_reference(touch, 5e6, 0.3, 0.7); });
}

std::vector<ParticleSettings> all_laws() {
  std::vector<ParticleSettings> all;
  for (const ContactLaw law : {ContactLaw::linear, ContactLaw::hertz}) {
    for (const RollingLaw rolling :
         {RollingLaw::none, RollingLaw::constant_torque, RollingLaw::spring_dashpot}) {
      for (const CohesionLaw cohesion :
           {CohesionLaw::none, CohesionLaw::sjkr, CohesionLaw::jkr, CohesionLaw::liquid_bridge}) {
        if (cohesion == CohesionLaw::jkr && law != ContactLaw::hertz) continue;
        ParticleSettings settings = law == ContactLaw::linear ? two_pairs() : elastic(5e6, 0.3);
        settings.contact.rolling = rolling;
        settings.contact.cohesion = cohesion;
        all.push_back(with(settings, [&](PairSettings& pair) {
          if (rolling != RollingLaw::none) pair.rolling_friction = 0.1;
          if (cohesion == CohesionLaw::sjkr) pair.cohesion_energy_density = 1e4;
          if (cohesion == CohesionLaw::jkr) pair.work_of_adhesion = 1e-3;
          if (cohesion == CohesionLaw::liquid_bridge) {
            pair.liquid_volume = 1e-12;
            pair.surface_tension = 0.07;
            pair.contact_angle = 0.5;
          }
        }));
      }
    }
  }
  return all;
}

TEST(ContactForce, is_the_same_in_floats_to_their_rounding) {
  for (const ParticleSettings& settings : all_laws()) {
    const ContactLaws laws(settings);
    const auto fine = law_table<double>(laws);
    const auto coarse = law_table<float>(laws);
    RandomContacts random;
    for (int i = 0; i < 200; ++i) {
      RandomContact one = random.next();
      // Inputs that floats hold exactly, so that only the arithmetic differs.
      const auto rounded = [](Vector3& v) { v = v.cast<float>().cast<double>(); };
      rounded(one.touch.normal);
      rounded(one.touch.velocity);
      rounded(one.touch.radius_spin);
      rounded(one.touch.spin);
      rounded(one.springs.tangential);
      rounded(one.springs.rolling);
      one.touch.overlap = static_cast<float>(one.touch.overlap);
      const Pushed a = push(fine, laws.index(0, 0), one.touch, one.springs, dt);
      const Pushed b = push(coarse, laws.index(0, 0), one.touch, one.springs, dt);
      // 20 roundings, at 6e-8 each, of terms that are for these contacts at most 0.02 N, 1e-5 N m,
      // 1e-5 m and 0.1 rad.
      const double tolerance = 20 * 6e-8;
      EXPECT_LT((a.force - b.force).norm(), tolerance * 0.02) << i;
      EXPECT_LT((a.lever - b.lever).norm(), tolerance * 0.02) << i;
      EXPECT_LT((a.torque - b.torque).norm(), tolerance * 1e-5) << i;
      EXPECT_LT((a.springs.tangential - b.springs.tangential).norm(), tolerance * 1e-5) << i;
      EXPECT_LT((a.springs.rolling - b.springs.rolling).norm(), tolerance * 0.1) << i;
      EXPECT_EQ(a.springs.bridge, b.springs.bridge);
    }
  }
}

TEST(ContactForce, is_zero_and_forgotten_where_nothing_is_near) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Touch broken;
  broken.normal = broken.velocity = broken.radius_spin = broken.spin = {nan, nan, nan};
  broken.overlap = broken.inverse_mass = broken.inverse_radius = broken.inverse_inertia = nan;
  Springs old;
  old.tangential = old.rolling = {1, 2, 3};
  old.bridge = 1;
  for (const ParticleSettings& settings : all_laws()) {
    const ContactLaws laws(settings);
    const Pushed got = push(law_table<double>(laws), 0, broken, old, dt, false);
    EXPECT_EQ(got.force, Vector3::Zero());
    EXPECT_EQ(got.lever, Vector3::Zero());
    EXPECT_EQ(got.torque, Vector3::Zero());
    EXPECT_EQ(got.springs.tangential, Vector3::Zero());
    if (laws.model().rolling == RollingLaw::spring_dashpot) {
      EXPECT_EQ(got.springs.rolling, Vector3::Zero());
    }
    if (laws.model().cohesion == CohesionLaw::liquid_bridge ||
        laws.model().cohesion == CohesionLaw::jkr) {
      EXPECT_EQ(got.springs.bridge, 0);
    }
    // Near, but apart: as far as forces go the same, unless a bridge stands.
    RandomContact apart = RandomContacts().next();
    apart.touch.overlap = -1e-5;
    apart.springs.bridge = 0;
    const Pushed away = push(law_table<double>(laws), 0, apart.touch, apart.springs, dt);
    EXPECT_EQ(away.force, Vector3::Zero());
    EXPECT_EQ(away.springs.tangential, Vector3::Zero());
  }
}

TEST(ContactForce, takes_the_pair_of_each_lane_from_the_table) {
  ParticleSettings settings = two_pairs();
  settings.contact.pairs[1].normal_stiffness = 3000;
  settings.contact.pairs[1].friction = 0.7;
  const ContactLaws laws(settings);
  const auto table = law_table<double>(laws);
  EXPECT_FALSE(table.one_law);
  EXPECT_TRUE(law_table<double>(ContactLaws(two_pairs())).one_law);
  const hn::ScalableTag<double> d;
  const hn::RebindToSigned<decltype(d)> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::vector<std::int64_t> pairs(hn::Lanes(d));
  for (int i = 0; i < lanes; ++i) pairs[i] = laws.index(0, i % 2);
  const auto law = load_law(d, table, hn::LoadU(di, pairs.data()));
  std::vector<double> normal(hn::Lanes(d));
  std::vector<double> friction(hn::Lanes(d));
  hn::StoreU(law.normal, d, normal.data());
  hn::StoreU(law.friction, d, friction.data());
  for (int i = 0; i < lanes; ++i) {
    EXPECT_EQ(normal[i], i % 2 == 0 ? 1000 : 3000);
    EXPECT_EQ(friction[i], i % 2 == 0 ? 0.3 : 0.7);
  }
}

TEST(ContactForce, keeps_as_many_numbers_as_its_laws_need) {
  EXPECT_EQ(spring_rows({}), 0);
  EXPECT_EQ(spring_rows({.friction = true}), 1);
  EXPECT_EQ(spring_rows({.rolling = RollingLaw::constant_torque, .friction = true}), 1);
  EXPECT_EQ(spring_rows({.rolling = RollingLaw::spring_dashpot, .friction = true}), 2);
  EXPECT_EQ(spring_rows({.cohesion = CohesionLaw::liquid_bridge}), 1);
  EXPECT_EQ(spring_rows({.cohesion = CohesionLaw::jkr}), 1);
}

}  // namespace
}  // namespace fluxpact
