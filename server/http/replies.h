// Replies that many routes use: JSON with an ETag, files with ranges.
#pragma once

#include <string>
#include <vector>

#include "server/http/message.h"
#include "server/jobs/service.h"

namespace hairbake {

HttpReply json_reply(int status, std::string json);

/// The reply with a header `Warning: 299 - "TEXT"` for each text.
HttpReply with_warnings(HttpReply reply, const std::vector<std::string>& texts);

/// JSON with an ETag made from it; 304 when the client has that already.
HttpReply cached_json(const HttpRequest& request, std::string json);
/// The same for a text whose digest is known.
HttpReply cached_json(const HttpRequest& request, std::string json, const std::string& digest);

/// A blob; its digest is its strong ETag. Understands If-None-Match, If-Range and one Range; a request with several
/// ranges gets the whole blob.
HttpReply file_reply(const HttpRequest& request, OpenBlob blob, const std::string& digest, const std::string& type);

/// The same for a text with the ETag `digest`.
HttpReply text_reply(const HttpRequest& request, const std::string& text, const std::string& digest,
                     const std::string& type);

/// Media type of a file, by the ending of its name.
std::string media_type(const std::string& name);

}  // namespace hairbake
