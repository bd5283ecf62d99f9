"""Photographs, and the workbooks that are put into a folder for the night: where they are, and how much is spent."""

import re

from pydantic import Field, field_validator

from pipeline.errors import InputError
from pipeline.settings.operations import SettingsPart

_HOST = re.compile(
    r"(?:\*\.(?=[^:]*\.))?(?:[^\W_](?:[\w-]*[^\W_])?)(?:\.[^\W_](?:[\w-]*[^\W_])?)*(?::\d{1,5})?|\[[0-9a-fA-F:]+\](?::\d{1,5})?"
)


class ImageSettings(SettingsPart):
    """Photographs of the objects: where they may be, and how much a night spends on them."""

    folder: str = Field(
        default="", description="the folder below which the files are that the records name; empty: files are not shown"
    )
    hosts: tuple[str, ...] = Field(
        default=(),
        max_length=100,
        description='the hosts that may be asked, such as "images.museum.org", "localhost:8182" or "*.museum.org" (a '
        "star allows no address of a private network); none: nothing is fetched",
    )
    pixels: int = Field(default=240, ge=64, le=1024, description="of the longer side of a thumbnail")
    megabytes: float = Field(default=30.0, gt=0.0, le=500.0, description="of a photograph at most")
    megapixels: float = Field(default=100.0, gt=0.0, le=1000.0, description="of a photograph at most")
    seconds: float = Field(default=10.0, gt=0.0, le=300.0, description="for one photograph at most")
    minutes: float = Field(
        default=30.0, gt=0.0, le=1440.0, description="for all new ones of a night; the others wait for the next one"
    )
    ask_again_days: float = Field(
        default=30.0, ge=0.0, le=3650.0, description="after which a host is asked whether a photograph has changed"
    )

    @field_validator("hosts")
    @classmethod
    def _hosts(cls, hosts: tuple[str, ...]) -> tuple[str, ...]:
        for host in hosts:
            if not _HOST.fullmatch(host):
                raise InputError(
                    f"{host!r} is no host: write its name alone, with its port where that is unusual, as "
                    "images.museum.org or localhost:8182"
                )
        return hosts


class SurveySettings(SettingsPart):
    """Workbooks of the survey that come back filled in."""

    inbox: str = Field(
        default="",
        description="a folder: what is put into it is taken up by the next night, as `kouros import --sheet` would; "
        "empty: none",
    )
