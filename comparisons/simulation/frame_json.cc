#include "comparisons/simulation/frame_json.h"

namespace softfinger::simulation {
namespace {

nlohmann::json vector_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

nlohmann::json bodies_json(const Frame& frame, const std::vector<RecordedBody>& bodies) {
  nlohmann::json result = nlohmann::json::array();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Eigen::Quaterniond turn(frame.poses[b].linear());
    if (turn.w() < 0) turn.coeffs() *= -1;
    result.push_back(
        {{"name", bodies[b].name},
         {"position_m", vector_json(frame.poses[b].translation())},
         {"quaternion_wxyz", {turn.w(), turn.x(), turn.y(), turn.z()}},
         {"velocity_m_per_s", vector_json(frame.velocities_m_per_s[b])},
         {"angular_velocity_rad_per_s", vector_json(frame.angular_velocities_rad_per_s[b])}});
  }
  return result;
}

nlohmann::json contacts_json(const Frame& frame, const std::vector<RecordedBody>& bodies) {
  nlohmann::json result = nlohmann::json::array();
  for (const RecordedContact& contact : frame.contacts) {
    const Eigen::Vector3d force =
        contact.axes * Eigen::Vector3d(contact.tangent_force_1_N, contact.tangent_force_2_N,
                                       contact.normal_force_N);
    result.push_back(
        {{"bodies", {bodies[std::size_t(contact.a)].name, bodies[std::size_t(contact.b)].name}},
         {"point_m", vector_json(contact.point_m)},
         {"normal", vector_json(contact.axes.col(2))},
         {"force_N", vector_json(force)},
         {"normal_force_N", contact.normal_force_N},
         {"torque_Nm", contact.torque_Nm},
         {"semi_axes_m", {contact.semi_axis_a_m, contact.semi_axis_b_m}},
         {"eccentricity_m", contact.eccentricity_m},
         {"utilisation", contact.utilisation},
         {"slides", contact.slides},
         {"model", contact.model},
         {"friction_law", std::string(contact.friction->name)}});
  }
  return result;
}

}  // namespace softfinger::simulation
