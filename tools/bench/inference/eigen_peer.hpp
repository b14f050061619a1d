// The seam to the Eigen peer, which is compiled several times: plain C types only, so that no code of one
// level is taken for that of another.
#pragma once

namespace patella::bench {

/// Tensors as the weights file has them, row after row.
struct PeerWeights {
  const float* weight_ih;
  const float* weight_hh;
  const float* bias_ih;
  const float* bias_hh;
  const float* fc_weight;
  const float* fc_bias;
  const float* in_proj_weight;
  const float* in_proj_bias;
  const float* out_proj_weight;
  const float* out_proj_bias;
  const float* output_weight;
  const float* output_bias;
};

struct PeerFunctions {
  void* (*make)(const PeerWeights& weights);
  void (*destroy)(void* peer);
  /// Returns the first output.
  float (*whole)(void* peer, const float* features);
  float (*recurrent)(void* peer, const float* features);
};

}  // namespace patella::bench

/// For x86-64-v4 (AVX-512), -v3 (AVX2, FMA) and what every processor of the architecture has.
extern "C" const patella::bench::PeerFunctions patella_eigen_peer_base;
extern "C" const patella::bench::PeerFunctions patella_eigen_peer_v3;
extern "C" const patella::bench::PeerFunctions patella_eigen_peer_v4;
