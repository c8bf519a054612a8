// SPDX-License-Identifier: Apache-2.0
// Files that a mesh file refers to.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "files/file_view.h"

namespace standoff {

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
