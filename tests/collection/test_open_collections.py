"""Rows of the open data of museums that were not seen before, as they stand there, and what a person reads from them.

From the data sets of the Institut national d'histoire de l'art (Agorha: the Rothschild gifts and the Musée des
Monuments français of Lenoir), the Museu do Ouro in Sabará, the Museu das Bandeiras and the Museu Regional Casa dos
Ottoni (IBRAM, Tainacan), and the Minneapolis Institute of Art;
columns of prose and addresses of pictures are left out, no cell is changed.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.guess import Guess, guess
from pipeline.collection.guessing.likeness import misspelt
from pipeline.collection.guessing.names import complements, named
from pipeline.collection.reading import read_items
from pipeline.records import Item

GIFTS = """\
artwork,artwork - UNIT,artwork - UNIQUE_KEY,artwork - DISPLAY_DENOMINATION,artwork - TITRE,artwork - HAUTEUR,\
artwork - DISPLAY_MATIERE,artwork - LARGEUR,artwork - DISPLAY_TECHNIQUE
"\n  ",mètre,22904,peinture,Sainte Apolline ; saint Michel,"0,23",bois,"0,09",peinture à l'huile
"\n  ",mètre,23160,peinture,La Vierge et l'Enfant avec deux anges,"0,798",bois,"0,550",peinture à l'huile
"\n  ",mètre,134462,peinture,Ange au luth,"0,58",toile,"0,43",peinture à fresque
"\n  ",mètre,229165,arme orientale,,,,,
"\n  ",centimètre,228513,peinture,Cinq saintes et saints et la Vierge,190,bois/toile,42,
"\n  ",centimètre,251581,objet d'art européen,Seau « à demi-bouteille »,"15,2",porcelaine tendre,"18,3",
"\n  ",centimètre,251832,meuble domestique,Ensemble de tables consoles de Pierre Leriche,74,bois,72,
"\n  ",centimètre,251840,meuble domestique,"Mobilier de salon : un canapé, six fauteuils et six chaises",103,\
bois/noyer/tissu,179,sculpture/peinture
"""
GIVEN = {
    "22904": (0.23, "framed"),
    "23160": (0.798, "framed"),
    "134462": (0.58, "framed"),
    "229165": (None, "mounted"),
    "228513": (1.90, "framed"),
    "251581": (0.152, "vessel"),
    "251832": (0.74, "table"),
    "251840": (1.03, "seat"),
}

MONUMENTS = """\
artwork - HAUTEUR,artwork - TITRE,artwork - UNIQUE_KEY,artwork - DISPLAY_DENOMINATION,artwork - DISPLAY_MATIERE,\
artwork - LARGEUR,artwork - DISPLAY_TECHNIQUE
"1,15",Saint Jean l'Evangéliste,135048,statue,marbre/albâtre,,
"0,76","Charles IX (Saint-Germain-en-Laye, 1550-Vincennes, 1574), roi de France",135346,buste,\
marbre/albâtre/marbre noir,"0,595",taillé
"1,29",Le fleuve Rhin,135156,bas-relief,plâtre,"0,37",
97,La Crucifixion,137488,bas-relief,marbre,79,taillé
"0,67","François-Marie Arouet, dit Voltaire, écrivain (1694-1778)",135159,buste,marbre,"0,58",taillé
"1,48",La Force,135189,statue,marbre,"0,63",taillé
"""

GOLD = """\
Características técnicas,Classificação,Denominação,Dimensões,Document,Link do Item,Material/Técnica,\
Número de registro,Título
"Móvel em madeira, composto de 12 partes de madeira recortada, encaixadas e coladas; assento revestido de couro, que \
era fixado originalmente por tachas metálicas, com um recorte circular ao meio.",05 Interiores > 05.5 Peça de \
Mobiliário,Tamborete sanitário,"Altura (cm): 48,0 Largura (cm): 36,0 Comprimento (cm): Profundidade (cm):36,0 \
Diâmetro (cm): Peso (g): Circunferência (cm):",6410,https://museudoouro.acervos.museus.gov.br/acervo/\
tamborete-sanitario/,couro | madeira recortada,679,
"Imagem esculpida em um só bloco de madeira, dourada e policromada em vermelho, preto, branco e bege; punções e \
esgrafitos; furo na cabeça para resplendor.",02 Artes Visuais/Cinematográfica > 02.3 Escultura,Escultura Religiosa,\
"Altura (cm): 47,0 Largura (cm): 23,5 Comprimento (cm): Profundidade (cm): 18,5 Diâmetro (cm): Peso (g): \
Circunferência (cm):",6342,https://museudoouro.acervos.museus.gov.br/acervo/escultura-religiosa-46/,dourada | madeira \
esculpida | policromada,641,Santa Catarina de Siena
"Cruz em prata martelada e fundida, banhada a ouro, com esmaltado branco e vermelho; alça martelada e cinzelada, \
encaixada.",09 Objetos Cerimoniais > 09.2 Objeto Comemorativo,Comenda,"Altura (cm): 9,0 Largura (cm): 4,5 Comprimento \
(cm): Profundidade (cm): 0,7 Diâmetro (cm): Peso (g): 50,0 Circunferência (cm):",6114,https://museudoouro.acervos.\
museus.gov.br/acervo/comenda-2/,esmalte | fundição | martelagem | prata dourada,524,Ordem de Cristo
"""


def read(text: str, folder: Path) -> tuple[Guess, dict[str, Item]]:
    path = folder / "export.csv"
    path.write_text(text, encoding="utf-8")
    found = guess(path)
    reading = read_items(path, found.mapping)
    assert reading.rejected == ()
    return found, {item.object_number: item for item in reading.items}


def test_each_row_has_the_unit_that_a_column_before_it_names(tmp_path: Path) -> None:
    """The unit stands left of the sizes, the decimals are commas in quotes, the names have a prefix in common."""
    found, items = read(GIFTS, tmp_path)
    assert {number: (item.height_m, classify(item).object_class) for number, item in items.items()} == {
        number: (None if height is None else pytest.approx(height), taken) for number, (height, taken) in GIVEN.items()
    }
    assert items["251581"].width_m == pytest.approx(0.183)
    assert items["22904"].medium == "bois, peinture à l'huile"
    assert "the medium is 'artwork - DISPLAY_MATIERE' and 'artwork - DISPLAY_TECHNIQUE' together" in found.sure


def test_metres_are_known_by_their_hundredths_and_what_cannot_be_is_refused(tmp_path: Path) -> None:
    """Without a column of units; two rows in centimetres among the others are no buildings."""
    found, items = read(MONUMENTS, tmp_path)
    assert items["135346"].height_m == pytest.approx(0.76)
    assert items["135189"].height_m == pytest.approx(1.48)
    assert items["137488"].height_m is None
    assert "'97' m is implausible" in items["137488"].problems[0].message
    assert [question.taken for question in found.questions if question.key == "unit"] == ["m"]
    assert [doubt for doubt in found.doubts if "metres are taken, for most are small" in doubt]


def test_small_things_in_centimetres_are_not_taken_for_metres(tmp_path: Path) -> None:
    rows = "".join(f"{at},Coin {at},2.{at},2.{at},0.{at}\n" for at in range(1, 9))
    found, _ = read("Inventory number,Title,Height,Width,Depth\n" + rows, tmp_path)
    assert [question.taken for question in found.questions if question.key == "unit"] == ["cm"]


def test_a_form_with_labels_left_empty(tmp_path: Path) -> None:
    """Prose is no object number, and neither is the number of a page on the web where a number is registered."""
    _, items = read(GOLD, tmp_path)
    assert {number: (item.height_m, item.width_m, item.depth_m) for number, item in items.items()} == {
        "679": pytest.approx((0.48, 0.36, 0.36)),
        "641": pytest.approx((0.47, 0.235, 0.185)),
        "524": pytest.approx((0.09, 0.045, 0.007)),
    }
    assert [classify(item).object_class for item in items.values()] == ["seat", "statue", "small_flat"]
    assert items["524"].mass_kg == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "Altura (cm): 19,5/90,0 (total) Diâmetro (cm): 11,5 Peso (g): 930,0",
            "Altura 19,5/90,0 cm (total), Diâmetro 11,5 cm, Peso 930,0 g",
        ),
        ("Height (cm): 12.5; Width (cm): 5", "Height 12.5 cm, Width 5 cm"),
        ("Height (cm): Width (cm):", "Height (cm): Width (cm):"),
        ("Height (cm): 12.5", "Height (cm): 12.5"),
        ("of the lid: Height (cm): 2 Width (cm): 5", "of the lid: Height (cm): 2 Width (cm): 5"),
    ],
)
def test_what_a_form_holds(text: str, said: str) -> None:
    assert plain_text(text) == said


def test_a_scroll_with_a_length_and_a_width_hangs(tmp_path: Path) -> None:
    """Minneapolis Institute of Art, 2000.38.1: which side is up is open, between the one and the other."""
    _, items = read(
        "Accession number,Title,Medium,Dimensions\n"
        "2000.38.1,Scenic Beauty Along Rivers and Mountains,Ink and colors on silk,"
        "L.64-5/16 x W.7-15/16 in. (image)\n"
        "16.675,Funerary papyrus,Papyrus,9 5/8 x 39 3/16 in. (24.4 x 99.5 cm)\n",
        tmp_path,
    )
    scene = classify(items["2000.38.1"])
    assert scene.object_class == "framed"
    height = scene.parameters["height"]
    assert (height.value, height.low, height.high) == pytest.approx((1.634, 0.2016, 1.634), rel=1e-3)
    assert "its length of 1.63" in height.note
    assert classify(items["16.675"]).object_class == "framed"


HOUSE = """\
Altura (cm),Classificação,Denominação,Document,Largura (cm),Localização atual,Material,Número de registro,\
Profundidade (cm),Técnica,Título,Diâmetro (cm),Comprimento (cm)
"1,82 m",06 Trabalho > 06.10 Equipamento Musical,Piano,37243,146,Exposição de Longa Duração - Sala da Família Ottoni,\
madeira | marfim | metal,500,63,manufatura,Piano Pleyel,,
64,02 Artes Visuais/Cinematográfica > 02.6 Pintura,Paisagem (pintura),37241,50,\
Exposição de Longa Duração - Sala de jantar,tecido | tinta,499,,óleo sobre tela | pintura,Casa dos Ottoni (Serro),,
42,08 Insígnias,Brasão (desenho),37239,33,,nanquim | papel | tinta,498,,desenho,Brasão da família Ottoni,,
,08 Insígnias,Medalha comemorativa,37225,,,bronze,494,,cunhagem,,"0,5",
10,12 Objetos Pessoais > 12.6 Objeto de Auxílio/Conforto Pessoais,Bengala,37195,,Reserva Técnica Museológica,\
madeira | metal,489,,entalhe | fundição,Bengala,,84
245,02 Artes Visuais/Cinematográfica > 02.3 Escultura,Estátua Alegórica (réplica),,108,Jardim,bronze,488,47,\
fundição | modelagem,Saracura/ Garça,,"Pescoço: 67 . Perna: 11 . Bico: 33,5"
,10 Comunicação > 10.1 Documento,Ofício,37186,,,papel | tinta,484,,impressão,,,
,03 Objetos Pecuniários,Apólice,37170,,,papel | tinta,479,,impressão | manuscrito,\
Apólice  de Ações nº 1749- Companhia Mucury,,
,10 Comunicação > 10.1 Documento,Livreto,37136,,,grampo de ferro | papel | tinta,471,,encadernação | impressão,\
Quem foi Júlio Benedicto Ottoni,,
"""


def test_a_house_with_its_papers_and_a_length_beside_the_depth(tmp_path: Path) -> None:
    found, items = read(HOUSE, tmp_path)
    assert items["500"].height_m == pytest.approx(1.82)
    assert {number: classify(item).object_class for number, item in items.items()} == {
        "500": "cabinet",
        "499": "framed",
        "498": "framed",
        "494": "small_flat",
        "489": "mounted",
        "488": "statue",
        "484": "small_flat",
        "479": "small_flat",
        "471": "small_flat",
    }
    assert [doubt for doubt in found.doubts if "no field takes the numbers of 'Comprimento (cm)'" in doubt]


def test_sizes_behind_a_technique_are_read_and_said(tmp_path: Path) -> None:
    found, items = read(
        "id,artist,title,year,technique\n"
        '1,Sandro Botticelli e bottega,Venere,1485-1490 ca,"Olio su tela, cm 174 x 77"\n'
        "2,Tommaso Della Porta,Busto di Minerva con elmo figurato,Sec. II a.C.,Marmo pario; marmo pentelico\n"
        "3,Giovanni Riccio,Giuseppina Bolognara,seconda metà XIX secolo,litografia\n",
        tmp_path,
    )
    assert [item.height_m for item in items.values()] == [pytest.approx(1.74), None, None]
    assert [classify(item).object_class for item in items.values()] == ["framed", "bust", "framed"]
    assert [doubt for doubt in found.doubts if "no column is for sizes: those in 'technique' are read" in doubt]
    film = "id,title,medium\n1,First,16mm film\n2,Second,35mm slide\n3,Third,oil on canvas\n"
    assert not [doubt for doubt in read(film, tmp_path)[0].doubts if "are read, look at each" in doubt]


def test_what_is_said_again_and_again_in_place_of_a_number_is_none(tmp_path: Path) -> None:
    rows = "Sem registro,36,Bandeira do Brasil,98\nSem registro,38,Mastro,212\n0101,39,Bandeira do Império,90\n"
    rows += "0102,40,Flâmula,40\n"
    found, items = read("Número de registro,Document,Denominação,Altura (cm)\n" + rows, tmp_path)
    assert list(items) == ["36", "38", "0101", "0102"]
    assert [doubt for doubt in found.doubts if "Sem registro" in doubt]


def test_sizes_in_sentences_are_read_and_said(tmp_path: Path) -> None:
    rows = (
        '1,Vase,"Porcelain vase with blue decoration, 12 cm high and 8 cm wide, made in Meissen about 1740."\n'
        "2,Desk,A plain desk from the town hall that was given by the mayor.\n"
        "3,Saint,He stands on a base 10 cm high; the figure is 54 cm high\n"
        "4,Bowl,A bowl of brass that was used in the kitchen until 1920.\n"
        "5,Cup,A cup with the arms of the town on the one side of it.\n"
    )
    found, items = read("Inventory number,Title,Description\n" + rows, tmp_path)
    assert [item.height_m for item in items.values()] == [pytest.approx(0.12), None, pytest.approx(0.54), None, None]
    assert [doubt for doubt in found.doubts if "those in the sentences of 'Description' are read" in doubt]
    assert all(item.problems for item in items.values())


def test_names_of_columns_in_these_exports() -> None:
    assert misspelt("classification_id") is None
    assert misspelt("clasification") is not None
    for name in ("Número de registro", "Número de tombo", "numéro d'enregistrement", "numero di registro"):
        said = named(name)
        assert said is not None
        assert said.field == "object_number"
        assert not said.internal
    assert complements("artwork - DISPLAY_MATIERE", "artwork - DISPLAY_TECHNIQUE")
    assert complements("Material", "Técnica")
    assert complements("materials", "techniques")
    assert not complements("Material/Técnica", "Técnica")
    assert not complements("Medium", "Material")
