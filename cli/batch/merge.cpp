// SPDX-License-Identifier: Apache-2.0
// Many shards' manifests become one.
#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include "cli/batch/manifest.h"
#include "files/atomic_file.h"
#include "files/atomic_folder.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kTries = 10;

// "manifest-3-of-64.jsonl".
std::optional<Shard> shard_of_name(const std::string& name) {
  constexpr std::string_view kBegin = "manifest-", kBetween = "-of-", kEnd = ".jsonl";
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) return std::nullopt;
  const char *at = name.data() + kBegin.size(), *const end = name.data() + name.size() - kEnd.size();
  Shard shard;
  const auto part = std::from_chars(at, end, shard.part);
  if (part.ec != std::errc() || !std::string_view(part.ptr, end).starts_with(kBetween)) return std::nullopt;
  const auto of = std::from_chars(part.ptr + kBetween.size(), end, shard.of);
  if (of.ec != std::errc() || of.ptr != end || shard.part < 1 || shard.part > shard.of) return std::nullopt;
  return shard;
}

// All shards, in order. Errors: usage, input.
std::vector<Shard> shards_in(const fs::path& folder) {
  const std::vector<Shard> found = parts_in(folder);
  if (found.empty())
    throw Error(ErrorCode::usage, folder.string() +
                                      ": there is no manifest of a shard in it, such as "
                                      "manifest-1-of-4.jsonl; give the folder that the shards wrote to");
  for (const Shard& shard : found)
    if (shard.of != found.front().of)
      throw Error(ErrorCode::input, folder.string() + ": shards of " + std::to_string(found.front().of) + " and of " +
                                        std::to_string(shard.of) + " lie side by side; take away those of one batch");
  for (std::int64_t part = 1; part <= found.front().of; ++part)
    if (part > static_cast<std::int64_t>(found.size()) || found[static_cast<std::size_t>(part - 1)].part != part)
      throw Error(ErrorCode::input, manifest_path(folder, {part, found.front().of}).string() +
                                        ": it is missing; run --shard " + std::to_string(part) + "/" +
                                        std::to_string(found.front().of));
  return found;
}

// What a shard says at its end.
struct ShardEnd {
  std::int64_t listed;
  std::string list_hash, parameters;
};

ShardEnd end_of(const fs::path& folder, const Shard& shard) {
  const fs::path path = summary_path(folder, shard);
  const std::string again =
      "run --shard " + std::to_string(shard.part) + "/" + std::to_string(shard.of) + " again with --resume";
  std::error_code ignored;
  if (!fs::exists(path, ignored))
    throw Error(ErrorCode::input, path.string() + ": it is missing, so the shard has not come to its end; " + again);
  try {
    const Json json = Json::parse(read_text(path));
    return {json.at("listed"), json.at("list_hash"), json.at("parameters")};
  } catch (const Json::exception&) {
    throw Error(ErrorCode::input, path.string() + ": this is no summary of a shard; " + again);
  }
}

// Where the last row of a mesh is.
struct Place {
  std::uint64_t offset = 0;
  std::uint32_t length = 0;  // 0: there is none
  std::int32_t shard = 0;
  int code = 0;
  bool unsure = false;
};

std::vector<Place> find_rows(const fs::path& folder, const std::vector<Shard>& shards, std::int64_t listed) {
  std::vector<Place> places(static_cast<std::size_t>(listed));
  for (std::size_t s = 0; s < shards.size(); ++s) {
    const fs::path path = manifest_path(folder, shards[s]);
    each_row(path, [&](const Json& row, const ManifestLine& line) {
      const std::int64_t index = row.at("index");
      if (index >= listed) return;  // of an earlier, longer list
      if (index < 0 || !shards[s].has(index))
        throw Error(ErrorCode::input, path.string() + ":line " + std::to_string(line.number) + ": mesh " +
                                          std::to_string(index) + " is not of this shard; run it again with -f");
      places[static_cast<std::size_t>(index)] = {line.offset, static_cast<std::uint32_t>(line.text.size() + 1),
                                                 static_cast<std::int32_t>(s), row.at("code").get<int>(),
                                                 is_unsure(row)};
    });
  }
  for (std::size_t index = 0; index < places.size(); ++index)
    if (places[index].length == 0) {
      const Shard missing{static_cast<std::int64_t>(index) % shards.front().of + 1, shards.front().of};
      throw Error(ErrorCode::input, manifest_path(folder, missing).string() + ": mesh " + std::to_string(index) +
                                        " of the list is missing; run --shard " + std::to_string(missing.part) + "/" +
                                        std::to_string(missing.of) + " again with --resume");
    }
  return places;
}

}  // namespace

std::vector<Shard> parts_in(const fs::path& folder) {
  std::vector<Shard> found;
  const auto look = [&] {
    found.clear();
    return all_entries(folder, [&](const char* name, bool) {
      if (const auto shard = shard_of_name(name)) found.push_back(*shard);
      return true;
    });
  };
  // An unfinished file of another part that has got its name between being listed and looked at is no reason to fail.
  for (int tries = 1; !look(); ++tries)
    if (tries == kTries)
      throw Error(ErrorCode::input, folder.string() + ": cannot read the folder; see to its name and permissions");
  std::ranges::sort(found, {}, &Shard::part);
  return found;
}

BatchSummary merge_shards(const fs::path& folder) {
  const std::vector<Shard> shards = shards_in(folder);
  const ShardEnd first = end_of(folder, shards.front());
  for (const Shard& shard : shards) {
    const ShardEnd end = end_of(folder, shard);
    const char* const differs = end.parameters != first.parameters                               ? "other options"
                                : end.listed != first.listed || end.list_hash != first.list_hash ? "another list"
                                                                                                 : nullptr;
    if (differs)
      throw Error(ErrorCode::input, manifest_path(folder, shard).string() + ": it is of " + differs + " than " +
                                        manifest_path(folder, shards.front()).string() +
                                        "; run both again with the same, and with --resume");
  }
  const std::vector<Place> places = find_rows(folder, shards, first.listed);

  BatchSummary summary;
  summary.listed = first.listed;
  summary.list_hash = parse_hash(first.list_hash).value_or(0);
  summary.parameters = first.parameters;
  std::vector<std::unique_ptr<FileView>> manifests;
  for (const Shard& shard : shards)
    manifests.push_back(std::make_unique<FileView>(manifest_path(folder, shard), FileView::Access::map));
  AtomicFile merged(manifest_path(folder, {}));
  for (const Place& place : places) {
    const std::string_view row = manifests[static_cast<std::size_t>(place.shard)]->text(place.offset, place.length);
    merged.write(row.data(), row.size());
    ++summary.counts[place.code];
    summary.unsure += place.unsure;
  }
  merged.commit();
  if (const auto array = array_layout_of(folder, summary.parameters))
    end_array(folder, *array, summary.listed, summary.parameters);
  wait_for_disk(folder);
  write_text(summary_path(folder, {}), json_text(summary_json(summary)));
  return summary;
}

}  // namespace standoff::cli
