#pragma once

#include <nlohmann/json.hpp>

/// Without this each file that handles JSON compiles the library's classes anew. The precompiled
/// headers include it, so that they are compiled once, in json_instances.cc.
extern template class nlohmann::basic_json<>;
extern template class nlohmann::detail::serializer<nlohmann::json>;
