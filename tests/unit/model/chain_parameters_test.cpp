// What a chain refuses, and what it takes.
#include <cmath>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include "tests/unit/model/chains.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

SerialChainParameters arm(int joints) {
  test::RandomChains random(23);
  return random.draw(joints);
}

template <typename Change>
void refuses(Change change, const std::string& expected) {
  SerialChainParameters parameters = test::asChain(PlanarTwoLinkParameters{
      .mass_kg = {7.0, 4.0}, .length_m = {0.4, 0.4}, .com_m = {0.2, 0.2}, .inertia_kg_m2 = {0.1, 0.1}});
  change(parameters.links);
  CHECK_THROWS_WITH_AS(SerialChain{parameters}, doctest::Contains(expected.c_str()), std::invalid_argument);
}

}  // namespace

TEST_CASE("links that no body could be are refused by link, value and expectation") {
  refuses([](auto& l) { l[0].mass_kg = -1.0; }, "link 1 'thigh': mass_kg = -1, expected 0 to 1000");
  refuses([](auto& l) { l[1].mass_kg = 0.0; },
          "link 2 'shank': mass_kg = 0, expected more than 0 with an inertia");
  refuses([](auto& l) { l[1].inertia_kg_m2 = {0.01, 0.02, 0.0302, 0, 0, 0}; },
          "link 2 'shank': inertia_kg_m2: largest principal moment = 0.0302, expected at most the sum");
  refuses([](auto& l) { l[1].inertia_kg_m2 = {0.1, 0.1, 0.1, 0.2, 0, 0}; },
          "link 2 'shank': inertia_kg_m2: principal moment = -0.0999");
  refuses([](auto& l) { l[0].axis.setZero(); }, "link 1 'thigh': length of axis = 0, expected a direction");
  refuses([](auto& l) { l[0].com_m.x() = std::nan(""); }, "link 1 'thigh': com_m[1] = nan");
  refuses([](auto& l) { l[0].origin_m.y() = std::numeric_limits<double>::infinity(); }, "origin_m[2] = inf");
  refuses([](auto& l) { l.clear(); }, "0 joints that are not fixed, expected 1 to 8");
  SerialChainParameters long_one = arm(8);
  CHECK_NOTHROW(SerialChain{long_one});
  long_one.links.push_back(long_one.links[0]);
  long_one.links.back().joint = ChainJoint::kRevolute;
  CHECK_THROWS_WITH_AS(SerialChain{long_one},
                       doctest::Contains("9 joints that are not fixed, expected 1 to 8"),
                       std::invalid_argument);
  SerialChainParameters heavy = arm(2);
  heavy.gravity_m_s2 = {9.0, 9.0, 0.0};
  CHECK_THROWS_WITH_AS(SerialChain{heavy}, doctest::Contains("magnitude of gravity_m_s2 = 12.7"),
                       std::invalid_argument);
}

TEST_CASE("a joint that moves nothing is refused, as its inertia has no inverse") {
  refuses(
      [](auto& l) {
        l[1].mass_kg = 0.0;
        l[1].inertia_kg_m2 = {};
      },
      "inertia that joint 2 moves, with those after it free = 0");
  // A point on the axis is not moved by it, either.
  refuses(
      [](auto& l) {
        l[1].com_m.setZero();
        l[1].inertia_kg_m2 = {};
      },
      "inertia that joint 2 moves");
}

TEST_CASE("frames, points, rods and what digits make of a plate are taken") {
  SerialChainParameters leg = arm(2);
  leg.links.push_back(test::frameAt(0.1));
  ChainLink plate;
  plate.name = "plate";
  plate.joint = ChainJoint::kFixed;
  plate.mass_kg = 0.5;
  plate.inertia_kg_m2 = {0.00123, 0.00234, 0.003572, 0.0, 0.0, 0.0};  // 0.06 % more than the sum
  leg.links.push_back(plate);
  plate.inertia_kg_m2 = {0.0, 0.002, 0.002, 0.0, 0.0, 0.0};
  leg.links.push_back(plate);
  plate.inertia_kg_m2 = {};
  leg.links.push_back(plate);
  CHECK_NOTHROW(SerialChain{leg});
}

TEST_CASE("links before the first joint are without effect, and what is fixed to a link is part of it") {
  SerialChainParameters bare = arm(3);
  std::erase_if(bare.links, [&](const ChainLink& link) {
    return &link == &bare.links.front() && link.joint == ChainJoint::kFixed;
  });
  SerialChainParameters based = bare;
  ChainLink base = test::frameAt(0.0);
  base.mass_kg = 0.0;
  base.inertia_kg_m2 = {0.05, 0.06, 0.03, 0.0, 0.0, 0.0};  // no body, and no matter
  based.links.insert(based.links.begin(), base);
  const SerialChain a(bare);
  const SerialChain b(based);
  for (const auto& [q, dq, ddq] : test::randomStates(3, 5)) {
    CHECK(a.inertia(q).isApprox(b.inertia(q), 1e-14));
    CHECK(a.gravity(q).isApprox(b.gravity(q), 1e-14));
  }
}

TEST_CASE("roll, pitch and yaw give the rotation back, at a pitch of a right angle too") {
  test::RandomChains random(1);
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector3d turn = random.vector(3.1);
    if (i % 2 == 0) {
      turn[1] = (i % 4 == 0 ? 1.0 : -1.0) * (1.5707963267948966 - std::pow(10.0, -(i % 17)));
    }
    const Eigen::Matrix3d rotation = rotationOf(turn);
    CHECK((rotationOf(turnOf(rotation)) - rotation).cwiseAbs().maxCoeff() < 4e-15);
  }
}
