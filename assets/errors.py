"""The only error class of this package."""


class AssetError(Exception):
    """An asset does not exist, or one of its files is missing or broken."""
