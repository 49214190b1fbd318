"""Client of hairbaked: sends hair models and environments, requests bakes, fetches the results. Standard library only.

    client = hairbake.Client("http://bake.example:8080", token_file="token")
    bake = client.submit(hair="groom.hair", environment="sky.hdr", transmittance={"directions": 64})
    result = client.fetch(client.wait(bake), "out")
    a = result.arrays()["transmittance"]
"""
from ._arrays import Array
from ._client import Bake, Batch, Client
from ._errors import BakeCancelled, BakeFailed, HairbakeError, Refused, Unreachable
from ._fetch import Result

__all__ = ["Array", "Bake", "BakeCancelled", "BakeFailed", "Batch", "Client", "HairbakeError", "Refused", "Result",
           "Unreachable"]
