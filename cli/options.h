// SPDX-License-Identifier: Apache-2.0
// One way to add an option whose text is parsed at once, so that a bad value is told before any work; and the options
// that several verbs have: of work, grids, signs and pictures.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/json.h"
#include "cli/parse.h"
#include "standoff/compute.h"
#include "standoff/grid.h"
#include "standoff/picture.h"
#include "standoff/sidecars.h"
#include "standoff/sign.h"

namespace standoff::cli {

/// The group of the options that rebuild the thesis. It stands last in a verb's help: add them last.
inline constexpr const char* kThesisGroup =
    "The thesis of 2008 and algorithms of others (docs/thesis.md, docs/methods.md)";

struct OptionText {
  const char* name;   ///< "-r,--resolution"
  const char* value;  ///< "N", as shown in the help
  const char* help;
  const char* group;
};

/// What add_parsed() passes on: an option's long name, or what was given for it.
using S = const std::string&;

/// `set(name, given)` gets the option's long name, for messages, and what was given.
template <class Set>
CLI::Option* add_parsed(CLI::App& verb, const OptionText& text, Set set) {
  const std::string name = text.name;
  const auto parsed = [set, shown = name.substr(name.find("--"))](const std::string& given) { set(shown, given); };
  return verb.add_option_function<std::string>(name, parsed, text.help)->option_text(text.value)->group(text.group);
}

/// Adds --device.
CLI::Option* add_device(CLI::App& verb, const char* group, Backend& backend, int& device);
/// The same for several GPUs.
CLI::Option* add_devices(CLI::App& verb, const char* group, Backend& backend, std::vector<int>& devices);
/// Adds --uncompressed, for fields that are written.
void add_uncompressed(CLI::App& verb, bool& uncompressed);
/// Adds --levels, for Zarr stores that are written.
void add_levels(CLI::App& verb, int& levels);
/// Adds -j.
CLI::Option* add_threads(CLI::App& verb, const char* group, int& threads);

/// A thickness as it was given; null: infinite.
Json thickness_json(const Thickness& thickness);

/// A grid, and the thickness in world units.
struct GridChoice {
  Grid grid;
  double thickness;
};

class GridOptions {
 public:
  /// `samples` is the default for the longest side.
  explicit GridOptions(std::int64_t samples = kDefaultResolution) : samples_(samples) {}

  /// Adds -r, --spacing, --size, --bounds, --padding and --thickness, and says which exclude which.
  void add_to(CLI::App& verb);
  /// The same but for --thickness, for verbs that compute no field.
  void add_without_thickness_to(CLI::App& verb);

  /// Whether any of them was given.
  bool given() const { return samples_given_ || spacing_ || size_ || bounds_ || padding_; }
  /// Whether one was given that says more than the resolution.
  bool shape_given() const { return spacing_ || size_ || bounds_ || padding_; }

  /// Adds --minimum and --speed, which exclude some of those. Call after it.
  void add_thesis_to(CLI::App& verb);

  /// What was chosen, whatever was left to a default, for programs that compare.
  Json parameters() const;

  /// The grid for a mesh with the given bounds. Errors: usage.
  GridChoice choose(const Box& mesh) const;
  /// What speaks against the thickness, for a warning: a whole number of world units that is much of the mesh was
  /// meant to be samples, mostly. Empty where nothing does.
  std::string doubt_of_thickness(const Box& mesh) const;
  /// The samples of the grid where they are the same for every mesh; nothing where the mesh decides them. Errors:
  /// usage.
  std::optional<Size3> known_size() const;

 private:
  Grid around(const Box& box) const;
  Padding padding() const;

  std::int64_t samples_;
  bool samples_given_ = false;
  std::optional<Vec3> spacing_;
  std::optional<Size3> size_;
  std::optional<double> minimum_;
  double speed_ = 0;
  std::optional<Box> bounds_;
  std::optional<double> padding_;  // samples
  Thickness thickness_{std::numeric_limits<double>::infinity()};
  bool thickness_is_whole_ = false;  // written as 3, not as 3.0, 0.5, 3s or inf
};

/// "grid 256 x 254 x 200, spacing 0.1, full field".
std::string grid_line(const GridChoice& choice);

/// Says of a method whether a verb takes it.
using TakesSign = bool (*)(const SignMethodInfo&);
inline bool takes_all(const SignMethodInfo&) { return true; }
inline bool takes_no_shell(const SignMethodInfo& info) { return info.method != SignMethod::shell; }

/// "auto (default), winding, parity or none": what `takes` takes.
std::string sign_names(TakesSign takes, SignMethod by_default);
/// "auto (default): what fits the mesh; winding, parity: by crossings; none": the same with what each is.
std::string sign_texts(TakesSign takes, SignMethod by_default);

/// What the help says. Lines are broken here.
struct SignHelp {
  std::string sign;
  std::string outer;
};

/// Adds --sign, with all methods, and what goes with it. The thickness of --sign shell goes to `shell`: it may be in
/// samples. The default is what `options` hold.
void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell, const SignHelp& help);
/// Does the same with the help of verbs that answer with distances.
void add_sign(CLI::App& verb, SignOptions& options, Thickness& shell);

/// Adds --sign, --rule, --invert, --as-oriented and --strict for verbs that ask about samples or triangles and not for
/// distances.
void add_sign_to(CLI::App& verb, TakesSign takes, const std::string& help, SignOptions& options);

/// Whether any of these options stands on the command line of a verb, with whatever value.
bool is_sign_given(const CLI::App& verb);

/// Adds how the sign was decided to an answer: `sign.method`, `sign.why` and `sign.sure`.
void add_sign_report(Json& json, const SignReport& report);

inline constexpr const char* kPictureGroup = "Picture";
inline constexpr const char* kUpHelp =
    "the axis that points up: x, y, z or auto (default): that of\nthe first file, by its format, or how it stands";

/// Adds --size, --camera, --up, --parallel, --samples, --background and --no-legend, with the defaults that `options`
/// has; returns them.
std::vector<const CLI::Option*> add_picture_options(CLI::App& verb, PictureOptions& options);

}  // namespace standoff::cli
