// SPDX-License-Identifier: Apache-2.0
// Files beside a mesh, and the URIs that name them or hold data themselves.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "files/file_view.h"

namespace standoff {

/// Whether it begins with a scheme, such as https: or file: or C:.
bool has_scheme(std::string_view uri);

/// %20 and its like as the bytes they stand for; a percent sign without two digits stays.
std::string percent_decoded(std::string_view uri);

/// Whether it holds its data itself: "data:...".
bool is_data_uri(std::string_view uri);

/// What a data URI holds (RFC 2397), in base64 or percent escapes; nothing where it is damaged.
std::optional<std::string> data_of_uri(std::string_view uri);

/// A relative URI as the path of a file in the mesh's folder or below it: its percent escapes decoded, parts "." left
/// out. Errors: input, as `FILE:WHERE: ...`, for what leaves the folder or names no file of it: an absolute path, a
/// part "..", a backslash, a scheme such as file: or https:, a control character.
std::string companion_path(const FileView& file, const std::string& where, const std::string& uri);

/// The bytes of such a file, `longest` at the most. What is no regular file (a pipe, a device, a folder) is never
/// opened, and no symbolic link is followed on the way there from the mesh's folder, whatever another program does
/// meanwhile. Errors: input, as `FILE:WHERE: ...`; limit, when memory runs out.
std::unique_ptr<FileView> open_companion(const FileView& file, const std::string& where, const std::string& path,
                                         std::uint64_t longest);

}  // namespace standoff
