CREATE TABLE exponaty (id int, inv_nomer varchar(20), naimenovanie varchar(200), material varchar(100), vysota_sm decimal(6,1), shirina_sm decimal(6,1), glubina_sm decimal(6,1), ves_kg decimal(7,2), mesto varchar(100));
INSERT INTO exponaty (id, inv_nomer, naimenovanie, material, vysota_sm, shirina_sm, glubina_sm, ves_kg, mesto) VALUES
(1,'КП-1204','Самовар «ваза»','латунь',52,38,36,6.4,'зал 3, витрина 2, полка 1'),
(2,'КП-1210','Братина','серебро',16,14,14,0.7,'зал 3, витрина 2, полка 2'),
(3,'КП-88','Бюст Пушкина','гипс',58,36,27,NULL,'зал 3, на постаменте'),
(4,'КП-310','Икона «Никола Можайский»','дерево, темпера',108,82,4,NULL,'зал 4, стена'),
(5,'КП-402','Сани выездные','дерево, железо',95,110,210,NULL,'зал 4, подиум'),
(6,'КП-507','Люстра','бронза, хрусталь',120,80,80,35,'зал 4, потолок'),
(7,'КП-911','Прялка','дерево',92,28,60,NULL,'фонд 2, стеллаж 5');
