// SPDX-License-Identifier: Apache-2.0
// What tests of standoff batch share: meshes to list, and manifests to look into.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/program.h"

namespace standoff::testing {

class BatchTest : public ProgramTest {
 protected:
  /// An octahedron of radius `size`, not centred, as OBJ.
  static std::string octahedron(double size = 1) {
    std::ostringstream text;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {size, -size})
        text << "v " << (axis == 0 ? side : 0) + 3 << ' ' << (axis == 1 ? side : 0) << ' ' << (axis == 2 ? side : 0)
             << '\n';
    text << "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    return text.str();
  }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder / name).parent_path());
    write_bytes(folder / name, text);
  }
  /// Writes octahedra mesh-0.obj .. of different sizes, and list.txt of them; returns their names.
  std::vector<std::string> write_meshes(int count) const {
    std::vector<std::string> names;
    std::string list;
    for (int n = 0; n < count; ++n) {
      names.push_back("mesh-" + std::to_string(n) + ".obj");
      write(names.back(), octahedron(1 + 0.125 * n));
      list += names.back() + "\n";
    }
    write("list.txt", list);
    return names;
  }

  /// The whole lines of a manifest.
  std::vector<Json> rows(const std::string& manifest = "out/manifest.jsonl") const {
    std::vector<Json> found;
    std::istringstream text(read_bytes(folder / manifest));
    for (std::string line; std::getline(text, line) && !text.eof();) found.push_back(Json::parse(line));
    return found;
  }
  /// The last row of every path.
  std::map<std::string, Json> last_rows(const std::string& manifest = "out/manifest.jsonl") const {
    std::map<std::string, Json> found;
    for (const Json& row : rows(manifest)) found[row["path"]] = row;
    return found;
  }
  /// Paths below a folder and the bytes of the files there.
  std::map<std::string, std::string> files(const std::string& below) const {
    std::map<std::string, std::string> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / below))
      if (entry.is_regular_file())
        found[entry.path().lexically_relative(folder / below).string()] = read_bytes(entry.path());
    return found;
  }
};

}  // namespace standoff::testing
