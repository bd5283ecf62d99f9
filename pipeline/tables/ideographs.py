"""Chinese signs in the two ways in which museums write them: a word of a table is found in either."""

from __future__ import annotations

_FULL = (
    "銅鐵銀錫鉛鋼鍍鐘鏡壺盤甕缽爐燈燭劍槍砲鎧馬車轎龍鳳龜魚鳥雞獸獅門櫃櫥風籃筆硯紙書畫軸冊頁圖經璽錢幣鈔"
    "郵繡織絲綢緞緙紗線襪褲飾鐲環鏈項釵瑪琺薩羅漢鐸鈴簫嗩儀電攝標礦齒貝殼蟲質題號編處庫陳覽廳層樓館區貨狀"
    "態現況稱長寬徑圍體積總淨單雙對組備註說語國產買賣獻贈購來時間歷曆戰紅黃藍綠鬥窯蠟蓮獎獵農鋸錘釘鎖鑰針"
    "燙縫紡輪軌橋類別數財見記錄舊舉與內兩個臺壽貓漁網彈盃罈罎"
)
_SHORT = (
    "铜铁银锡铅钢镀钟镜壶盘瓮钵炉灯烛剑枪炮铠马车轿龙凤龟鱼鸟鸡兽狮门柜橱风篮笔砚纸书画轴册页图经玺钱币钞"
    "邮绣织丝绸缎缂纱线袜裤饰镯环链项钗玛珐萨罗汉铎铃箫唢仪电摄标矿齿贝壳虫质题号编处库陈览厅层楼馆区货状"
    "态现况称长宽径围体积总净单双对组备注说语国产买卖献赠购来时间历历战红黄蓝绿斗窑蜡莲奖猎农锯锤钉锁钥针"
    "烫缝纺轮轨桥类别数财见记录旧举与内两个台寿猫渔网弹杯坛坛"
)
_SHORTER = str.maketrans(_FULL, _SHORT)


def shortened_signs(text: str) -> str:
    """Return a text with the short form of each sign that has one: 銅鏡 as 铜镜.

    Signs that are another word in Japanese (機, 葉) are left as they are.

    text : any
    """
    return text if text.isascii() else text.translate(_SHORTER)
