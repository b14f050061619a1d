#include "tools/bench/inference/onnx_model.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "tools/bench/inference/contender.hpp"

namespace patella::bench {
namespace {

/// A message in protocol buffers' wire format, https://protobuf.dev/programming-guides/encoding.
class Message {
 public:
  Message& number(int field, std::int64_t value) {
    varint(static_cast<std::uint64_t>(field) << 3);
    varint(static_cast<std::uint64_t>(value));
    return *this;
  }
  Message& bytes(int field, std::string_view value) {
    varint((static_cast<std::uint64_t>(field) << 3) | 2);
    varint(value.size());
    text_ += value;
    return *this;
  }
  Message& message(int field, const Message& value) { return bytes(field, value.text_); }

  const std::string& text() const { return text_; }

 private:
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) {
      text_ += static_cast<char>(value | 0x80);
    }
    text_ += static_cast<char>(value);
  }

  std::string text_;
};

// Field numbers below are those of onnx.proto3, https://github.com/onnx/onnx.
constexpr std::int64_t kFloat = 1;    // TensorProto.DataType
constexpr std::int64_t kInt64 = 7;    // likewise
constexpr std::int64_t kIsInt = 2;    // AttributeProto.AttributeType
constexpr std::int64_t kAreInts = 7;  // likewise
constexpr std::int64_t kOpset = 13;
constexpr std::int64_t kIrVersion = 8;

using Shape = std::vector<std::int64_t>;
using Names = std::vector<std::string>;

class Graph {
 public:
  void node(const std::string& operation, const Names& inputs, const Names& outputs,
            const std::vector<std::pair<std::string, std::int64_t>>& attributes = {}) {
    Message message;
    for (const std::string& input : inputs) {
      message.bytes(1, input);
    }
    for (const std::string& output : outputs) {
      message.bytes(2, output);
    }
    message.bytes(4, operation);
    for (const auto& [name, value] : attributes) {
      message.message(5, Message().bytes(1, name).number(3, value).number(20, kIsInt));
    }
    graph_.message(1, message);
  }

  void transpose(const std::string& input, const std::string& output, const std::vector<std::int64_t>& axes) {
    Message order = Message().bytes(1, "perm");
    for (const std::int64_t axis : axes) {
      order.number(8, axis);
    }
    order.number(20, kAreInts);
    graph_.message(1, Message().bytes(1, input).bytes(2, output).bytes(4, "Transpose").message(5, order));
  }

  void constant(const std::string& name, const Shape& shape, const std::vector<float>& values) {
    tensor(name, shape, kFloat,
           {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)});
  }
  void constant(const std::string& name, const std::vector<std::int64_t>& values) {
    tensor(name, {static_cast<std::int64_t>(values.size())}, kInt64,
           {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(std::int64_t)});
  }

  void input(const std::string& name, const Shape& shape) { graph_.message(11, valueInfo(name, shape)); }
  void output(const std::string& name, const Shape& shape) { graph_.message(12, valueInfo(name, shape)); }

  std::string model() {
    graph_.bytes(2, "network");
    return Message()
        .number(1, kIrVersion)
        .message(7, graph_)
        .message(8, Message().bytes(1, "").number(2, kOpset))
        .text();
  }

 private:
  void tensor(const std::string& name, const Shape& shape, std::int64_t type, std::string_view raw) {
    Message message;
    for (const std::int64_t dimension : shape) {
      message.number(1, dimension);
    }
    graph_.message(5, message.number(2, type).bytes(8, name).bytes(9, raw));
  }

  static Message valueInfo(const std::string& name, const Shape& shape) {
    Message dimensions;
    for (const std::int64_t dimension : shape) {
      dimensions.message(1, Message().number(1, dimension));
    }
    const Message tensor_type = Message().number(1, kFloat).message(2, dimensions);
    return Message().bytes(1, name).message(2, Message().message(1, tensor_type));
  }

  Message graph_;
};

/// PyTorch's gates i, f, g, o in ONNX's order i, o, f, g.
template <typename Tensor>
void appendGates(std::vector<float>& values, const Tensor& tensor) {
  const Eigen::Index rows = tensor.rows() / 4;
  for (const Eigen::Index gate : {0, 3, 1, 2}) {
    const network::WeightMatrix block = tensor.middleRows(gate * rows, rows);
    values.insert(values.end(), block.data(), block.data() + block.size());
  }
}

template <typename Tensor>
std::vector<float> valuesOf(const Tensor& tensor) {
  return {tensor.data(), tensor.data() + tensor.size()};
}

void addRecurrent(Graph& graph, const network::NetworkWeights& weights) {
  const network::LstmWeights& lstm = weights.lstm.front();
  std::vector<float> input;
  std::vector<float> recurrent;
  std::vector<float> bias;
  appendGates(input, lstm.weight_ih);
  appendGates(recurrent, lstm.weight_hh);
  appendGates(bias, lstm.bias_ih);
  appendGates(bias, lstm.bias_hh);
  graph.constant("lstm_w", {1, 4 * kHidden, kInputs}, input);
  graph.constant("lstm_r", {1, 4 * kHidden, kHidden}, recurrent);
  graph.constant("lstm_b", {1, 8 * kHidden}, bias);
  graph.constant("fc_w", {kChannels, kHidden}, valuesOf(weights.fc_weight));
  graph.constant("fc_b", {kChannels}, valuesOf(weights.fc_bias));
  graph.constant("row_of_hidden", {1, kHidden});
  graph.node("LSTM", {"features", "lstm_w", "lstm_r", "lstm_b", "", "hidden", "cell"},
             {"", "next_hidden", "next_cell"}, {{"hidden_size", kHidden}});
  graph.node("Reshape", {"next_hidden", "row_of_hidden"}, {"h"});
  graph.node("Gemm", {"h", "fc_w", "fc_b"}, {"dense"}, {{"transB", 1}});
}

constexpr std::int64_t kWidth = kChannels / kHeads;
constexpr std::int64_t kToTheEnd = std::numeric_limits<std::int32_t>::max();

/// `newest` behind all but the first of `past` along an axis.
void addShift(Graph& graph, const std::string& past, const std::string& newest, const std::string& next,
              std::int64_t axis) {
  const std::string axis_name = past + "_axis";
  graph.constant(axis_name, {axis});
  graph.node("Slice", {past, "second", "end", axis_name}, {past + "_kept"});
  graph.node("Concat", {past + "_kept", newest}, {next}, {{"axis", axis}});
}

/// From `z`: the query by heads, `next_keys` and `next_values` from those kept and the newest.
void addKeptKeys(Graph& graph, const network::NetworkWeights& weights) {
  graph.constant("in_w", {3 * kChannels, kChannels}, valuesOf(weights.in_proj_weight));
  graph.constant("in_b", {3 * kChannels}, valuesOf(weights.in_proj_bias));
  graph.constant("thirds", {kChannels, kChannels, kChannels});
  graph.constant("as_column", {kHeads, kWidth, 1});
  graph.node("Gemm", {"z", "in_w", "in_b"}, {"projected"}, {{"transB", 1}});
  graph.node("Split", {"projected", "thirds"}, {"q_flat", "k_flat", "v_flat"}, {{"axis", 1}});
  graph.node("Reshape", {"k_flat", "as_column"}, {"k"});
  graph.node("Reshape", {"v_flat", "as_row"}, {"v"});
  addShift(graph, "keys", "k", "next_keys", 2);
  addShift(graph, "values", "v", "next_values", 1);
  const Shape keys = {kHeads, kWidth, weights.window};
  const Shape values = {kHeads, weights.window, kWidth};
  graph.input("keys", keys);
  graph.input("values", values);
  graph.output("next_keys", keys);
  graph.output("next_values", values);
}

/// The same with all keys and values from `next_past`.
void addKeysAnew(Graph& graph, const network::NetworkWeights& weights) {
  addShift(graph, "past", "z", "next_past", 0);
  for (const int third : {0, 1, 2}) {
    const network::WeightMatrix weight = weights.in_proj_weight.middleRows(third * kChannels, kChannels);
    const Eigen::VectorXf bias = weights.in_proj_bias.segment(third * kChannels, kChannels);
    const std::string name(1, "qkv"[third]);
    graph.constant(name + "_w", {kChannels, kChannels}, valuesOf(weight));
    graph.constant(name + "_b", {kChannels}, valuesOf(bias));
    graph.node("Gemm", {third == 0 ? "z" : "next_past", name + "_w", name + "_b"}, {name + "_flat"},
               {{"transB", 1}});
  }
  graph.constant("by_heads", {weights.window, kHeads, kWidth});
  graph.node("Reshape", {"k_flat", "by_heads"}, {"k"});
  graph.node("Reshape", {"v_flat", "by_heads"}, {"v"});
  graph.transpose("k", "next_keys", {1, 2, 0});
  graph.transpose("v", "next_values", {1, 0, 2});
  graph.input("past", {weights.window, kChannels});
  graph.output("next_past", {weights.window, kChannels});
}

void addAttention(Graph& graph, const network::NetworkWeights& weights, OnnxForm form) {
  graph.constant("out_w", {kChannels, kChannels}, valuesOf(weights.out_proj_weight));
  graph.constant("out_b", {kChannels}, valuesOf(weights.out_proj_bias));
  graph.constant("y_w", {kOutputs, kChannels}, valuesOf(weights.output_weight));
  graph.constant("y_b", {kOutputs}, valuesOf(weights.output_bias));
  graph.constant("scale", {1}, std::vector<float>{1.0F / std::sqrt(static_cast<float>(kWidth))});
  graph.constant("as_row", {kHeads, 1, kWidth});
  graph.constant("as_channels", {1, kChannels});
  graph.constant("second", {1});
  graph.constant("end", {kToTheEnd});
  if (form == OnnxForm::kKept) {
    addKeptKeys(graph, weights);
  } else {
    addKeysAnew(graph, weights);
  }
  graph.node("Reshape", {"q_flat", "as_row"}, {"q_unscaled"});
  graph.node("Mul", {"q_unscaled", "scale"}, {"q"});
  graph.node("MatMul", {"q", "next_keys"}, {"scores"});
  graph.node("Softmax", {"scores"}, {"attention"}, {{"axis", 2}});
  graph.node("MatMul", {"attention", "next_values"}, {"by_head"});
  graph.node("Reshape", {"by_head", "as_channels"}, {"context"});
  graph.node("Gemm", {"context", "out_w", "out_b"}, {"attended"}, {{"transB", 1}});
  graph.node("Gemm", {"attended", "y_w", "y_b"}, {"result"}, {{"transB", 1}});
}

}  // namespace

std::string onnxModel(const network::NetworkWeights& weights, OnnxForm form) {
  const bool whole = form != OnnxForm::kRecurrent;
  Graph graph;
  graph.input("features", {1, 1, kInputs});
  for (const char* state : {"hidden", "cell"}) {
    graph.input(state, {1, 1, kHidden});
    graph.output(std::string("next_") + state, {1, 1, kHidden});
  }
  addRecurrent(graph, weights);
  graph.node("Tanh", {"dense"}, {whole ? "z" : "result"});
  if (whole) {
    addAttention(graph, weights, form);
  }
  graph.output("result", {1, whole ? kOutputs : kChannels});
  return graph.model();
}

}  // namespace patella::bench
