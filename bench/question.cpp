#include "question.h"

#include <cstdio>
#include <map>
#include <stdexcept>

namespace difi::bench {

Question parse_question(const std::string& text) {
  static const std::map<std::string, Query> queries{{"collide", Query::collide},
                                                    {"contacts", Query::contacts},
                                                    {"all_contacts", Query::all_contacts},
                                                    {"distance", Query::distance},
                                                    {"sweep", Query::sweep}};
  const std::size_t at = text.find('@');
  const auto query = queries.find(text.substr(0, at));
  if (query == queries.end()) throw std::invalid_argument("no such query: " + text);
  Question question{query->second, query->first};
  if (at == std::string::npos) return question;
  Vec3 place;
  char rest = 0;
  if (std::sscanf(text.c_str() + at + 1, "%lf,%lf,%lf%c", &place.x, &place.y, &place.z, &rest) != 3)
    throw std::invalid_argument("not three numbers: " + text);
  question.place = place;
  return question;
}

}  // namespace difi::bench
