"""Requests that no client sends by mistake, as bytes for a raw socket."""
from harness import sha256

STOLEN = b"smuggled"  # a blob that is stored only when a part of a request was served as a request of its own


def smuggled(token):
    return (f"PUT /v1/blobs/{sha256(STOLEN)} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n"
            f"Content-Length: {len(STOLEN)}\r\n\r\n").encode() + STOLEN


def smuggling_requests(token, put, chunks):
    """Name -> text. Each hides the request smuggled() in another one; `put` and `chunks` are the beginnings of that."""
    hidden = smuggled(token).decode()
    address = hidden.split("\r\n")[0].replace(" ", "%20")
    return {
        "smuggled behind both framings": put + f"Content-Length: {5 + len(hidden)}\r\n" + chunks + "0\r\n\r\n" + hidden,
        "smuggled in a chunk behind a short length": put + "Content-Length: 4\r\n" + chunks + f"{len(hidden):x}\r\n{hidden}\r\n0\r\n\r\n",
        "smuggled behind a coding with a space": put + "Transfer-Encoding : chunked\r\nContent-Length: 5\r\n\r\n0\r\n\r\n" + "X" + hidden,
        "smuggled behind two lengths": put + f"Content-Length: 0\r\nContent-Length: {len(hidden)}\r\n\r\n" + hidden,
        "smuggled in an address": f"GET /v1/bakes%20HTTP/1.1%0d%0a%0d%0a{address} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n\r\n",
    }


def requests(token):
    """Name -> bytes. None of them may be answered with success, and none may store a blob. Each carries a valid token, so that
    what refuses it is not the lack of one."""
    authority = f"Host: localhost\r\nAuthorization: Bearer {token}\r\n"
    put = f"PUT /v1/blobs/{sha256(b'hello')} HTTP/1.1\r\n{authority}"
    get = f"GET /v1/bakes HTTP/1.1\r\n{authority}"
    chunks = "Transfer-Encoding: chunked\r\n\r\n"

    def line(target):
        return f"GET {target} HTTP/1.1\r\n{authority}\r\n"

    listed = {
        "both framings": put + "Content-Length: 5\r\n" + chunks + "5\r\nhello\r\n0\r\n\r\n",
        "both framings, the other order": put + "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n5\r\nhello\r\n0\r\n\r\n",
        "two lengths": put + "Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello",
        "the same length twice": put + "Content-Length: 5\r\nContent-Length: 5\r\n\r\nhello",
        "list of lengths": put + "Content-Length: 5, 5\r\n\r\nhello",
        "length with sign": put + "Content-Length: +5\r\n\r\nhello",
        "negative length": put + "Content-Length: -5\r\n\r\nhello",
        "length in hex": put + "Content-Length: 0x5\r\n\r\nhello",
        "length beyond 64 bits": put + "Content-Length: 99999999999999999999999999\r\n\r\nhello",
        "length of a terabyte": put + "Content-Length: 1099511627776\r\n\r\nhello",
        "gzip, chunked": put + "Transfer-Encoding: gzip, chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n",
        "two codings": put + "Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n\r\n5\r\nhello\r\n0\r\n\r\n",
        "unknown coding": put + "Transfer-Encoding: xchunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n",
        "compressed": put + "Content-Encoding: gzip\r\nContent-Length: 5\r\n\r\nhello",
        "multipart": put + "Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 5\r\n\r\nhello",
        "broken chunk": put + chunks + "zz\r\nhello\r\n0\r\n\r\n",
        "chunk of negative size": put + chunks + "-5\r\nhello\r\n0\r\n\r\n",
        "chunk beyond 64 bits": put + chunks + "fffffffffffffffff\r\nhello\r\n0\r\n\r\n",
        "chunk longer than it says": put + chunks + "3\r\nhello\r\n0\r\n\r\n",
        "no host": "GET /v1/bakes HTTP/1.1\r\n\r\n",
        "two hosts": get + "Host: other\r\n\r\n",
        "encoded CR LF in a header": get + "X-Test: a%0d%0aX-Evil: 1\r\n\r\n",
        "encoded CR LF in the address": line("/v1/bakes%0d%0aX-Evil:%201"),
        "encoded CR LF in the query": line("/v1/bakes?state=%0d%0aX-Evil:%201"),
        "10,000 headers": get + "".join(f"X-{i}: 1\r\n" for i in range(10000)) + "\r\n",
        "a header of 10 MB": get + "X: " + "a" * 10_000_000 + "\r\n\r\n",
        "a header line of 100 MB": get + "X: " + "a" * 100_000_000,
        "a header name of 1 MB": get + "a" * 1_000_000 + ": 1\r\n\r\n",
        "address of 20 KB": line("/" + "a" * 20000),
        "dots": line("/v1/blobs/../../etc/passwd"),
        "dots to nginx's files": line("/v1/../blobs/aa/" + "a" * 64),
        "encoded dots": line("/v1/%2e%2e/x"),
        "encoded slash": line("/v1/blobs%2f..%2f..%2fetc%2fpasswd"),
        "twice encoded dots": line("/v1/blobs/%252e%252e/x"),
        "backslashes": line("/v1/blobs/..\\..\\hairbake.db"),
        "zero byte": line("/v1/bakes%00"),
        "two slashes": line("//v1/bakes"),
        "no slash": line("v1/bakes"),
        "unknown method": f"BREW /v1/bakes HTTP/1.1\r\n{authority}\r\n",
        "trace": f"TRACE / HTTP/1.1\r\n{authority}\r\n",
        "connect": f"CONNECT 127.0.0.1:22 HTTP/1.1\r\n{authority}\r\n",
        "no HTTP": "hello\r\n\r\n",
        "HTTP/9.9": "GET /v1/bakes HTTP/9.9\r\nHost: localhost\r\n\r\n",
        "TLS to a plain port": "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + "\x00" * 64 + "\r\n\r\n",
        "only line ends": "\r\n" * 1000,
    }
    listed |= smuggling_requests(token, put, chunks)
    return {name: text.encode("latin-1") for name, text in listed.items()}
