// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/threemf_package.h"

#include <algorithm>
#include <utility>

#include "files/file_view.h"
#include "files/inflate.h"
#include "files/xml_scan.h"
#include "standoff/error.h"

namespace standoff {
namespace {

std::string key(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return lower;
}

}  // namespace

ThreemfPackage::ThreemfPackage(const FileView& file) : file_(file) {
  for (ZipMember& member : read_zip(file)) {
    std::string name = key(member.name);
    const auto [entry, is_new] = entries_.try_emplace(std::move(name));
    if (!is_new) file.fail(shown(member.name), "the archive holds this part twice; write the file again");
    entry->second.member = std::move(member);
  }
}

ThreemfPackage::Entry* ThreemfPackage::find(std::string_view name) {
  const auto found = entries_.find(key(name));
  return found == entries_.end() ? nullptr : &found->second;
}

const FileView& ThreemfPackage::part(std::string_view name) {
  Entry* entry = find(name);
  if (!entry) file_.fail("", "the archive holds no part " + in_quotes(name) + "; get all of it, or write it again");
  return unpack(*entry);
}

const FileView& ThreemfPackage::unpack(Entry& entry) {
  if (entry.part) return *entry.part;
  const ZipMember& member = entry.member;
  const std::uint64_t most = most_unpacked(file_.size());
  if (member.bytes > most - unpacked_)
    throw Error(ErrorCode::limit, file_.path().string() + ":" + shown(member.name) +
                                      ": with it the file unpacks to more than " + std::to_string(most >> 20) +
                                      " MiB, where one of its size may have no more; write the mesh as STL or PLY");
  unpacked_ += member.bytes;
  entry.stream = std::make_unique<ZipMemberStream>(file_, member);
  entry.part = std::make_unique<FileView>(file_, file_.path().string() + ":" + shown(member.name),
                                          entry.stream->next(member.bytes));
  return *entry.part;
}

const FileView& ThreemfPackage::model() {
  constexpr std::string_view kModel = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
  std::string target = "3D/3dmodel.model";
  if (Entry* relations = find("_rels/.rels")) {
    XmlScan scan(unpack(*relations));
    XmlTag tag{};
    while (scan.next(tag)) {
      if (!tag.opens() || tag.local_name() != "Relationship") continue;
      const std::string_view type = tag.attribute("Type");
      if (type.ends_with("/keystore")) scan.fail("the file is encrypted; save it without protection");
      if (type == kModel) target = tag.attribute("Target");
    }
  }
  return part(target);
}

}  // namespace standoff
