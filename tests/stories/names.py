"""Who the shared data's patients are, so that tests can look for them where they must not be."""

import itertools
import json
import re
import tarfile

import dicom_header as dicom

SHORTEST = 4
# Fewer bytes than this turn up by chance in compressed voxels.
SHORTEST_IN_BINARY = 7
# Parts of made-up names that a program or a series description may well say for itself.
ORDINARY_WORDS = {"Modality", "Perfusion", "Stroke", "Test"}


class Names:
    """The patients' names and identifiers: whole, and a name's parts; raw, UTF-8 and escaped."""

    def __init__(self, data):
        reference = json.loads((data / "reference.json").read_text(encoding="utf-8"))
        known = {f.get("patient_name_utf8") for f in reference["files"].values()} - {None, "None"}
        paths, values = [], {name.encode("utf-8") for name in known}
        for path, content in contents_of(data):
            paths.append(path)
            elements = dicom.read(content)
            for tag in (dicom.PATIENT_NAME, dicom.PATIENT_ID):
                if isinstance(elements.get(tag), bytes):
                    values.add(elements[tag].strip(b"\0 "))
        all_paths = "\n".join(paths).encode("utf-8")
        words = {word for value in values for word in (value, *parts(value))}
        self.words = {word for word in words if len(word) >= SHORTEST and word not in all_paths}
        forms = {form for word in self.words for form in forms_of(word)}
        self.long = [form for form in forms if len(form) >= SHORTEST_IN_BINARY]
        self.short = own_words(form for form in forms if len(form) < SHORTEST_IN_BINARY)

    def found_in(self, content):
        """A name in these bytes, or None."""
        for form in self.long:
            if form in content:
                return form
        found = None if b"\0" in content else self.short.search(content)
        return found and found[0]

    def found_below(self, folder):
        """Each file below with a name in its content or path."""
        for path in sorted(folder.rglob("*")):
            name = self.found_in(str(path.relative_to(folder)).encode("utf-8"))
            if not name and path.is_file():
                name = self.found_in(path.read_bytes())
            if name:
                yield path, name


def contents_of(data):
    """Path and bytes of every file there is; of an archive, which is one series, its first ones."""
    for path in sorted(p for p in data.rglob("*") if p.is_file()):
        inside = str(path.relative_to(data))
        if path.name.endswith(".tar.xz"):
            with tarfile.open(path) as archive:
                for member in itertools.islice(filter(tarfile.TarInfo.isfile, archive), 3):
                    yield f"{inside}/{member.name}", archive.extractfile(member).read()
        else:
            yield inside, path.read_bytes()


def parts(name):
    """Family name, given name and so on, in each script; those in two bytes a letter as a whole."""
    found = [] if b"\x1b" in name else re.split(rb"[\^=]", name)
    return [p.strip() for p in found if p.strip().decode("latin-1") not in ORDINARY_WORDS]


def forms_of(word):
    """The bytes themselves, as one reads them wrongly as Latin-1, and as JSON escapes."""
    found = {word, word.decode("latin-1").encode("utf-8")}
    try:
        found.add(json.dumps(word.decode("utf-8")).strip('"').encode("ascii"))
    except UnicodeDecodeError:
        pass  # Another character set: its UTF-8 comes from the reference.
    return found


def own_words(forms):
    """A search for what stands alone: 0010 is not in 1.0010, nor Wang in Wangen."""
    return re.compile(rb"(?<![0-9A-Za-z.])(?:" + b"|".join(map(re.escape, sorted(forms)))
                      + rb")(?![0-9A-Za-z]|\.[0-9])")
