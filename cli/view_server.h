// SPDX-License-Identifier: Apache-2.0
// What the page of `standoff view` asks its server for (view/README.md).
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/serve.h"
#include "standoff/field.h"
#include "standoff/mesh.h"
#include "standoff/page.h"
#include "view/live/live_view.h"

namespace standoff::cli {

/// What was given on the command line.
struct ViewSubject {
  struct NamedMesh {
    std::string name;
    Mesh mesh;
    Axis up;
  };
  std::vector<NamedMesh> meshes;
  std::vector<std::string> field_names;
  std::vector<DistanceField> fields;

  /// They view this one.
  std::vector<PageMesh> page_meshes() const;
  std::vector<PageField> page_fields() const;
};

class ViewServer {
 public:
  /// `live`: the settings that the field of the first mesh begins with; none: what was given is shown, nothing
  /// computed.
  ViewServer(ViewSubject subject, const PageOptions& page, const std::optional<view::LiveSettings>& live,
             std::int64_t memory_limit, const Console& console);

  void answer(const view::Request& request, std::string_view route, view::Reply& reply);
  view::PageWatch& watch() { return watch_; }

 private:
  std::string state(std::optional<Axis> up = {}) const;  // of a mesh that has just come
  std::shared_ptr<const std::string> data(const std::string& id);
  void compute(const view::Request& request, view::Reply& reply);
  void say_new_sign();
  void point(const view::Request& request, view::Reply& reply);
  void upload(const view::Request& request, view::Reply& reply);
  void events(view::Reply& reply);

  ViewSubject subject_;
  PageOptions page_;
  std::unique_ptr<view::LiveView> live_;
  view::PageWatch watch_;

  const Console& console_;
  std::mutex saying_;
  std::string said_;  // of the sign, last

  std::mutex packing_;
  std::map<std::string, std::shared_ptr<const std::string>> packed_;  // by id and version
};

}  // namespace standoff::cli
