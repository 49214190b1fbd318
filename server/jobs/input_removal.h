// Deletes inputs on a client's wish, unless something still refers to them.
#pragma once

#include <string>

namespace hairbake {

class BlobStore;

/// Deletes a model's or an environment's entry and its thumbnail, and its blob too unless a result, an entry or a name
/// of another kind, or a thumbnail has the same bytes.
///
/// `kind` is "model" or "environment".
/// `force`: also if done bakes or versions of names refer to it.
/// Throws Refusal(not_found).
/// Throws Refusal(conflict) with the list of what refers to it (Refusal::needed_by()). A live bake refuses always.
void remove_input(BlobStore& store, const std::string& kind, const std::string& digest, bool force);

/// Deletes a blob that a client sent, for example a mesh. Bytes that are a result's too stay as such.
///
/// `force`: also if done bakes or versions of names refer to it.
/// Throws as remove_input(), and Refusal(conflict) for a blob that is a model, an environment, a thumbnail or a result
/// alone.
void remove_blob(BlobStore& store, const std::string& digest, bool force);

}  // namespace hairbake
