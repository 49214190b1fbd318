"""JSON bodies that are small for a client and would be large as values."""
import json

MEGABYTE = 1 << 20
BAKES, REBAKES, MODELS, NAME = "/v1/bakes", "/v1/rebakes", "/v1/models", "/v1/names/model/x"
LIMITS = {BAKES: MEGABYTE, REBAKES: 4 * MEGABYTE, MODELS: 64 << 10, NAME: 64 << 10}
SKY = '"environment":"sha256:' + "0" * 64 + '"'


def filled(start, item, end, limit):
    """start + item,item,... + end, of at most `limit` bytes."""
    count = (limit - len(start) - len(end)) // (len(item) + 1)
    return start + ",".join([item] * count) + end


def bodies_of_bakes():
    limit = LIMITS[BAKES]
    light = '{"direction":[0,1,0],"irradiance":[1,1,1]}'
    return {
        "4,000 outputs": json.dumps({"outputs": ["npy"] * 4000}),
        "130,000 outputs": filled('{"outputs":[', '"npy"', "]}", limit),
        "outputs of other types": filled('{"outputs":[', "0", "]}", limit),
        "whole lights": filled('{"irradiance":{"lights":[', light, "]}}", limit),
        "empty lights": filled('{"irradiance":{"lights":[', "{}", "]}}", limit),
        "a long direction": filled('{"irradiance":{"lights":[{"direction":[', "1", "]}]}}", limit),
        "a long rotation": filled('{"environment_settings":{"rotation_deg":[', "1", "]}}", limit),
        "a long tint at its deprecated place": filled('{"irradiance":{"tint":[', "1", "]}}", limit),
        "lists in a deprecated field": filled('{"irradiance":{"model":[', "[]", "]}}", limit),
        "objects in a number": filled('{"transmittance":{"directions":[', "{}", "]}}", limit),
        "lists in a text": filled('{"hair":[', "[[]]", "]}", limit),
        "unknown fields": "{" + ",".join(f'"x{i}":0' for i in range(90_000)) + "}",
        "one field many times": filled("{", '"hair":null', "}", limit),
        "a list of requests": filled("[", "{}", "]", limit),
    }


def bodies_of_rebakes():
    limit = LIMITS[REBAKES]
    light = '{"direction":[0,1,0],"irradiance":[1,1,1]}'
    return {
        "empty ids": filled("{" + SKY + ',"bakes":[', '""', "]}", limit),
        "numbers for ids": filled("{" + SKY + ',"bakes":[', "1", "]}", limit),
        "lists for ids": filled("{" + SKY + ',"bakes":[', "[]", "]}", limit),
        "50,000 unknown ids": "{" + SKY + ',"bakes":[' + ",".join(f'"{i:064x}"' for i in range(50_000)) + "]}",
        "models": filled("{" + SKY + ',"models":[', "{}", "]}", limit),
        "models and bakes": "{" + SKY + "," + ",".join(f'"{field}":[' + ",".join([f'"{"0" * 30}"'] * 50_000) + "]"
                                                        for field in ("bakes", "models")) + "}",
        "lights": filled("{" + SKY + ',"name":"x","irradiance":{"lights":[', light, "]}}", limit),
        "a long name": "{" + SKY + ',"name":"' + "x" * (limit - 200) + '"}',
        "more than the limit": filled('{"bakes":[', '""', "]}", 8 * limit),
    }


def bodies_of_any_route(limit):
    return {
        "nested lists": "[" * limit,
        "nested objects": '{"a":' * (limit // 5),
        "a long key": '{"' + "k" * (limit - 10) + '":1}',
        "a long text": '{"sha256":"' + "x" * (limit - 20) + '"}',
        "a text of escapes": '{"sha256":"' + "\\u0001" * ((limit - 20) // 6) + '"}',
        "a text without end": '{"sha256":"' + "\\" * (limit - 20),
        "a text of wrong bytes": b'{"sha256":"' + b"\xff" * (limit - 20) + b'"}',
        "a long number": '{"sha256":' + "1" * (limit - 20) + "}",
        "blanks": " " * limit,
        "zeros": b"\0" * limit,
        "texts": filled('{"note":[', '"xxxxxxxxxxxxxxxx"', "]}", limit),
    }


def hostile_bodies():
    """(path, name) -> bytes. None of them is a request that can be served."""
    found = {(BAKES, name): body for name, body in bodies_of_bakes().items()}
    found |= {(REBAKES, name): body for name, body in bodies_of_rebakes().items()}
    for path, limit in LIMITS.items():
        found |= {(path, name): body for name, body in bodies_of_any_route(limit).items()}
    return {key: body if isinstance(body, bytes) else body.encode() for key, body in found.items()}
