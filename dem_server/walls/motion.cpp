#include "dem_server/walls/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fluxpact {
namespace {

double argument(const MotionSettings& motion, double time) {
  return 2 * std::numbers::pi * motion.frequency * time + motion.phase;
}

}  // namespace

Pose pose_at(const MotionSettings& motion, double time) {
  Pose pose;
  switch (motion.type) {
    case MotionType::none:
      break;
    case MotionType::translation:
      pose.shift = time * motion.velocity;
      pose.velocity = motion.velocity;
      break;
    case MotionType::rotation: {
      const Vector3 axis = motion.direction.normalized();
      pose.turns = true;
      pose.pivot = motion.point;
      pose.turn = Eigen::AngleAxisd(motion.rate * time, axis).toRotationMatrix();
      pose.spin = motion.rate * axis;
      break;
    }
    case MotionType::vibration: {
      const double at = argument(motion, time);
      pose.shift = std::sin(at) * motion.amplitude;
      pose.velocity = 2 * std::numbers::pi * motion.frequency * std::cos(at) * motion.amplitude;
      break;
    }
  }
  return pose;
}

double displacement(const MotionSettings& motion, double since, double time, double arm) {
  switch (motion.type) {
    case MotionType::none:
      break;
    case MotionType::translation:
      return motion.velocity.norm() * std::abs(time - since);
    case MotionType::rotation: {
      const double angle = std::min(std::abs(motion.rate * (time - since)), std::numbers::pi);
      return 2 * arm * std::sin(0.5 * angle);
    }
    case MotionType::vibration:
      return motion.amplitude.norm() *
             std::abs(std::sin(argument(motion, time)) - std::sin(argument(motion, since)));
  }
  return 0;
}

double largest_speed(const MotionSettings& motion, double arm) {
  switch (motion.type) {
    case MotionType::none:
      break;
    case MotionType::translation:
      return motion.velocity.norm();
    case MotionType::rotation:
      return std::abs(motion.rate) * arm;
    case MotionType::vibration:
      return 2 * std::numbers::pi * std::abs(motion.frequency) * motion.amplitude.norm();
  }
  return 0;
}

}  // namespace fluxpact
