// SPDX-License-Identifier: Apache-2.0
#include "io/field/npy.h"

#include <array>
#include <cstring>
#include <string_view>

#include "core/number_text.h"
#include "files/file_view.h"
#include "files/text.h"

namespace standoff {
namespace {

constexpr std::string_view kNumpyMagic = "\x93NUMPY";
constexpr std::uint64_t kAlignment = 64;

// The header is a Python dictionary: {'descr': '<f4', 'fortran_order': True, 'shape': (2, 3, 4), }
class Dictionary {
 public:
  explicit Dictionary(std::string_view text) : rest_(text) {}

  bool read(NpyHeader& header) {
    if (!take('{')) return false;
    int found = 0;
    while (!take('}')) {
      std::string key;
      if (!quoted(key) || !take(':')) return false;
      const bool good = key == "descr"           ? quoted(header.type)
                        : key == "fortran_order" ? boolean(header.fortran_order)
                        : key == "shape"         ? tuple(header.shape)
                                                 : false;
      if (!good) return false;
      ++found;
      if (!take(',') && !rest_.starts_with('}')) return false;
    }
    return found == 3 && trimmed(rest_).empty();
  }

 private:
  bool take(char c) {
    rest_ = trimmed(rest_);
    if (!rest_.starts_with(c)) return false;
    rest_ = trimmed(rest_.substr(1));
    return true;
  }
  bool quoted(std::string& text) {
    const char quote = rest_.empty() ? ' ' : rest_.front();
    if (quote != '\'' && quote != '"') return false;
    const auto end = rest_.find(quote, 1);
    if (end == std::string_view::npos) return false;
    text = rest_.substr(1, end - 1);
    rest_ = trimmed(rest_.substr(end + 1));
    return true;
  }
  bool boolean(bool& value) {
    value = rest_.starts_with("True");
    if (!value && !rest_.starts_with("False")) return false;
    rest_ = trimmed(rest_.substr(value ? 4 : 5));
    return true;
  }
  bool tuple(std::vector<std::int64_t>& values) {
    if (!take('(')) return false;
    values.clear();
    while (!take(')')) {
      const auto end = rest_.find_first_of(",) ");
      const auto value = number_in<std::int64_t>(rest_.substr(0, end));
      if (end == std::string_view::npos || !value || *value < 0) return false;
      values.push_back(*value);
      rest_ = trimmed(rest_.substr(end));
      if (!take(',') && !rest_.starts_with(')')) return false;
    }
    return true;
  }

  std::string_view rest_;
};

}  // namespace

std::string npy_header(const NpyHeader& header, std::uint64_t room) {
  const std::string quote = header.type.starts_with('[') ? "" : "'";
  std::string text = "{'descr': " + quote + header.type + quote +
                     ", 'fortran_order': " + (header.fortran_order ? "True" : "False") + ", 'shape': (";
  for (const auto side : header.shape) text += std::to_string(side) + ",";
  text += "), }";
  const std::uint64_t before = kNumpyMagic.size() + 4;
  text.append((kAlignment - (before + text.size() + 1) % kAlignment) % kAlignment, ' ');
  if (before + text.size() + 1 < room) text.append(room - before - text.size() - 1, ' ');
  text += '\n';
  const auto length = static_cast<std::uint16_t>(text.size());
  return std::string(kNumpyMagic) + '\1' + '\0' + static_cast<char>(length & 0xFF) + static_cast<char>(length >> 8) +
         text;
}

NpyArray read_npy(const FileView& file, const std::string& name, std::string_view start, std::uint64_t bytes) {
  const auto fail = [&](const std::string& what) { file.fail(shown(name), what); };
  if (start.size() < 10 || !start.starts_with(kNumpyMagic)) fail("it is no NumPy array; write the file again");
  const bool short_length = start[6] == 1;
  if (start[6] < 1 || start[6] > 3 || (!short_length && start.size() < 12))
    fail("its version of the NumPy format is unknown; save it with another NumPy");
  std::uint32_t length = 0;
  std::memcpy(&length, start.data() + 8, short_length ? 2 : 4);
  const std::uint64_t header = short_length ? 10 : 12;
  if (length > kMaxNpyHeader - header || length > bytes - header)
    fail("its header reaches past its end; the file is damaged, write it again");
  NpyArray array;
  if (!Dictionary(start.substr(header, length)).read(array))
    fail("its header describes no plain array; save one of numbers, not of records or objects");
  array.offset = header + length;
  array.bytes = bytes - array.offset;
  return array;
}

void NpzArrays::begin(const std::string& name, const NpyHeader& header, std::uint64_t bytes) {
  const std::string text = npy_header(header);
  zip_.begin(name + ".npy", text.size() + bytes);
  zip_.write(std::as_bytes(std::span(text)));
}

void NpzArrays::small(const std::string& name, const NpyHeader& header, std::span<const std::byte> bytes) {
  begin(name, header, bytes.size());
  write(bytes);
  end();
}

void NpzArrays::vector(const std::string& name, const Vec3& v) {
  const std::array values{v.x, v.y, v.z};
  small(name, {"<f8", {3}, false}, std::as_bytes(std::span(values)));
}

void NpzArrays::size(const std::string& name, const Size3& v) {
  const std::array values{v.x, v.y, v.z};
  small(name, {"<i8", {3}, false}, std::as_bytes(std::span(values)));
}

}  // namespace standoff
