// Replies that many routes give: JSON with an ETag, files with ranges.
#pragma once

#include <string>

#include "server/http/message.h"
#include "server/jobs/service.h"

namespace hairbake {

/// The request's body as text. It was counted against the route's limit.
std::string read_text(const HttpRequest& request);

HttpReply json_reply(int status, std::string json);

/// JSON that is asked for again and again: an ETag made from it, 304 when the client has it.
HttpReply cached_json(const HttpRequest& request, std::string json);
/// The same of a text whose digest is known.
HttpReply cached_json(const HttpRequest& request, std::string json, const std::string& digest);

/// A blob, whose digest is its strong ETag: If-None-Match, one Range (If-Range counts), 416 with Content-Range. More
/// than one range is answered with the whole.
HttpReply file_reply(const HttpRequest& request, OpenBlob blob, const std::string& digest, const std::string& type);

/// The same of a text, with the ETag `digest`.
HttpReply text_reply(const HttpRequest& request, const std::string& text, const std::string& digest,
                     const std::string& type);

/// Media type by the name's ending.
std::string media_type(const std::string& name);

}  // namespace hairbake
